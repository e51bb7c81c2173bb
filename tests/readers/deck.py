"""Reads the decks that `billow export --deck` writes, and compares them with each other and with the history of the job.

    deck.py RADIOSS.rad DYNA.k HISTORY.h5

Both decks are read by columns, as their codes read them. The first difference ends the program with exit code 1.
"""

import json
import sys

import h5py
import numpy as np


def blocks(path, mark, comments):
    """(keyword, lines) of each block; a keyword begins with `mark`."""
    found = []
    for line in open(path, encoding="ascii"):
        line = line.rstrip("\n")
        if line.startswith(comments):
            continue
        if line.startswith(mark):
            found.append((line, []))
        else:
            found[-1][1].append(line)
    return found


def fields(line, *widths):
    """The numbers of a line, by the widths of its columns; a blank is 0."""
    ends = np.cumsum(widths)
    texts = [line[end - width : end].strip() for width, end in zip(widths, ends)]
    assert not line[ends[-1] :].strip(), f"text beyond the columns: {line!r}"
    return [float(text) if text else 0.0 for text in texts]


def table(lines, *widths):
    return np.array([fields(line, *widths) for line in lines])


class Radioss:
    def __init__(self, path):
        all_blocks = blocks(path, "/", "#")
        self.blocks = {key: lines for key, lines in all_blocks}
        assert len(self.blocks) == len(all_blocks), "a keyword with its number stands twice"
        at = self.blocks
        nodes = table(at["/NODE"], 10, 20, 20, 20)
        self.nodes = {int(node): position for node, *position in nodes}
        self.elements, self.reference = {}, {}
        for key, lines in at.items():
            if key.startswith("/SH3N/"):
                part = int(key.split("/")[-1])
                assert f"/PART/{part}" in at and part in table(at["/SURF/PART/1"][1:], *[10] * 10)
                self.elements |= {int(e): (part, *map(int, abc)) for e, *abc in table(lines, 10, 10, 10, 10)}
            if key.startswith("/EREF/SH3N/"):
                self.reference |= {int(e): tuple(map(int, abc)) for e, *abc in table(lines[1:], 10, 10, 10, 10)}
        law, section = at["/MAT/LAW19/1"], at["/PROP/TYPE9/1"]
        self.density, (self.stiffness, _, self.ratio) = fields(law[1], 20)[0], fields(law[2], 20, 20, 20)
        self.thickness = fields(section[3], 10, 10, 20, 20, 10, 10, 10)[2]
        gas = at["/MAT/GAS/MASS/2"]
        self.gas_constant = 8.314462618 / fields(gas[1], 20)[0]
        self.cp = fields(gas[2], *[20] * 5)[0]
        volume = at["/MONVOL/AIRBAG1/1"]
        self.heat_transfer = fields(volume[1], 10, 10, 20)[2]
        _, _, _, self.ambient, self.temperature, _, _ = fields(volume[3], 10, 10, 20, 20, 20, 10, 10)
        self.inflows = []
        for line in volume[5 : 5 + int(volume[4])]:
            inject = at[f"/PROP/INJECT1/{int(fields(line, *[10] * 6)[0])}"]
            material, curve, _, _, scale, temperature = fields(inject[2], 10, 10, 10, 10, 20, 20)
            assert (material, scale) == (2, 1) and fields(inject[1], 10, 10, 20) == [1, 0, 1], inject
            points = table(at[f"/FUNCT/{int(curve)}"][1:], 20, 20)
            self.inflows.append((points, temperature))
        self.supports = []
        for key, lines in at.items():
            if key.startswith("/BCS/"):
                group = int(fields(lines[1][10:], 10, 10)[1])
                held = table(at[f"/GRNOD/NODE/{group}"][1:], *[10] * 10).astype(int).ravel()
                self.supports.append((lines[1][3:6], sorted(set(held) - {0})))
        contact = at.get("/INTER/TYPE7/1")
        self.gap = fields(contact[4], *[20] * 5)[2] if contact else None


class Dyna:
    def __init__(self, path):
        self.blocks = blocks(path, "*", "$")
        nodes = table(self.one("*NODE"), 8, 16, 16, 16)
        self.nodes = {int(node): position for node, *position in nodes}
        shells = table(self.one("*ELEMENT_SHELL"), *[8] * 6).astype(int)
        reference = table(self.one("*AIRBAG_SHELL_REFERENCE_GEOMETRY"), *[8] * 6).astype(int)
        assert (shells[:, 4] == shells[:, 5]).all() and (shells[:, 1] == reference[:, 1]).all()
        self.elements = {e: (part, a, b, c) for e, part, a, b, c, _ in shells.tolist()}
        self.reference = {e: (a, b, c) for e, _, a, b, c, _ in reference.tolist()}
        law, section = self.one("*MAT_FABRIC_TITLE"), self.one("*SECTION_SHELL_TITLE")
        _, self.density, self.stiffness, _, _, self.ratio = fields(law[1], *[10] * 6)
        self.thickness = fields(section[2], *[10] * 4)[0]
        bag = self.one("*AIRBAG_HYBRID")
        self.temperature, self.ambient, _, constant, _, self.heat_transfer = fields(bag[1], *[10] * 6)
        curves = {}
        for key, lines in self.blocks:
            if key == "*DEFINE_CURVE_TITLE":
                curves[int(fields(lines[1], 10, 10)[0])] = table(lines[2:], 20, 20)
        self.inflows = []
        for line in bag[4::2]:
            rate, temperature, _, mass, _, heat, _, _ = fields(line, *[10] * 8)
            self.gas_constant, self.cp = constant / mass, heat / mass
            points = curves[int(rate)]
            total = np.concatenate([[0], np.cumsum(np.diff(points[:, 0]) * (points[1:, 1] + points[:-1, 1]) / 2)])
            self.inflows.append((np.column_stack([points[:, 0], total]), curves[int(temperature)][0, 1]))
        assert len(self.inflows) == int(fields(bag[3], *[10] * 6)[2])
        sets = {}
        for key, lines in self.blocks:
            if key == "*SET_NODE_LIST_TITLE":
                members = table(lines[2:], *[10] * 8).astype(int).ravel()
                sets[int(fields(lines[1], 10)[0])] = sorted(set(members) - {0})
        held = [table(lines, *[10] * 8).astype(int)[0] for key, lines in self.blocks if key == "*BOUNDARY_SPC_SET"]
        self.supports = [("".join(map(str, row[2:5])), sets[row[0]]) for row in held]
        contact = [lines for key, lines in self.blocks if key == "*CONTACT_AIRBAG_SINGLE_SURFACE"]
        self.gap = fields(contact[0][2], *[10] * 8)[2] if contact else None

    def one(self, keyword):
        found = [lines for key, lines in self.blocks if key == keyword]
        assert len(found) == 1, (keyword, len(found))
        return found[0]


def check_shape(deck, volume, frame, triangles):
    """Film of this volume (m3) that encloses it, in the shape of a frame, each element with a reference of its size."""
    film = np.array([deck.nodes[node + 1] for node in range(len(frame))])
    assert np.abs(film - frame).max() < 1e-6, np.abs(film - frame).max()
    elements = np.array([deck.elements[e + 1][1:] for e in range(len(deck.elements))]) - 1
    assert (elements == triangles).all()
    a, b, c = (film[elements[:, corner]] for corner in range(3))
    enclosed = np.einsum("ij,ij->", a, np.cross(b, c)) / 6
    assert abs(enclosed / volume - 1) < 1e-5, (enclosed, volume)
    edges = np.sort(np.concatenate([elements[:, [i, (i + 1) % 3]] for i in range(3)]), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all(), "the film is open"
    corners = np.array([[deck.nodes[node] for node in deck.reference[e + 1]] for e in range(len(elements))])
    lengths = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    now = np.linalg.norm(film[elements] - np.roll(film[elements], 1, axis=1), axis=2)
    # Folding stretches nothing but the caps, which are folded from flat polygons.
    assert np.median(np.abs(now / lengths - 1)) < 1e-2, np.median(np.abs(now / lengths - 1))
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (normals[:, 2] > 0).all() and np.abs(normals[:, :2]).max() < 1e-12
    return normals[:, 2].sum() / 2


def main(radioss, dyna, history):
    first, second = Radioss(radioss), Dyna(dyna)
    with h5py.File(history) as file:
        scene = json.loads(file.attrs["scene"])
        frames = file["VTKHDF/Steps/Values"].size
        frame = file["VTKHDF/Points"][:].reshape(frames, -1, 3)[0]
        triangles = file["VTKHDF/Connectivity"][:].reshape(-1, 3)
        times = file["history/time"][:]
        volume = file["history/volume"][0]
    release, film, gas = scene["release_time"], scene["film"], scene["gas"]
    for deck, digits in ((first, 1e-12), (second, 2e-5)):
        area = check_shape(deck, volume, frame, triangles)
        asked = [film["density"], film["youngs_modulus"], film["poisson_ratio"], film["thickness"], film["temperature"], gas["species"]["cp"]]
        asked += [gas["species"]["gas_constant"]]
        held = [deck.density, deck.stiffness, deck.ratio, deck.thickness, deck.temperature, deck.cp, deck.gas_constant]
        assert np.allclose(held, asked, rtol=max(digits, 1e-9)), (held, asked)
        # All gas of the job until its end, less the ambient gas that fills the volume at the start.
        end = times[-1]
        supplied = gas["initial_mass"] + sum(w["rate"] * max(0, min(w["to"], end) - w["from"]) for w in gas["windows"])
        supplied -= gas["ambient_pressure"] * volume / (gas["species"]["gas_constant"] * film["temperature"])
        flown = sum(np.interp(end - release, *points.T) for points, _ in deck.inflows)
        assert np.isclose(flown, supplied, rtol=1e-3), (flown, supplied)  # a leak takes less
        assert len(deck.supports) == len(scene["supports"]), deck.supports
        for (held, nodes), support in zip(deck.supports, scene["supports"]):
            assert held == "".join(str(int(axis in support["fix"])) for axis in "xyz"), held
            heights = [deck.nodes[node][2] for node in nodes]
            assert len(nodes) >= 6 and np.ptp(heights) < 1e-9, heights
        print(f"deck: {len(deck.elements)} elements, {area:.6g} m2, {flown:.6g} kg of gas, gap {deck.gap:.4g} m")
    assert first.reference == second.reference and first.elements == second.elements
    positions = [np.array(list(deck.nodes.values())) for deck in (first, second)]
    assert np.abs(positions[0] - positions[1]).max() < 1e-9
    assert np.isclose(first.gap, second.gap, rtol=1e-3) and first.gap > film["thickness"]
    assert np.allclose([t for _, t in first.inflows], [t for _, t in second.inflows], rtol=1e-4)


if __name__ == "__main__":
    main(*sys.argv[1:])
