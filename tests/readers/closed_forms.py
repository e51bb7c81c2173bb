"""SALib, Optuna and egobox on the closed forms of billow's tests, at equal budgets.

    pip install SALib optuna torch egobox numpy scipy
    python tests/readers/closed_forms.py

Not a part of any check: it gives the figures of others in docs/experiments.md. The functions are those of
study/src/surrogate/tests.rs and study/src/study/optimise/tests.rs.
"""

import warnings

import egobox
import numpy as np
import optuna
from SALib.analyze import sobol as analyze
from SALib.sample import sobol as sample

SEEDS = range(1, 11)
G = np.array([0, 1, 4.5, 9, 99])
ALPHA, BETA = np.sqrt(12) - 6 * np.sqrt(0.3), 12 * np.sqrt(0.3)


def ishigami(u):
    x = np.pi * (2 * u - 1)
    return np.sin(x[:, 0]) * (1 + 0.1 * x[:, 2] ** 4) + 7 * np.sin(x[:, 1]) ** 2


def sobol_g(u):
    return np.prod((abs(4 * u - 2) + G) / (1 + G), axis=1)


def morris(u):
    total, squares = u[:, :4].sum(1), (u[:, :4] ** 2).sum(1)
    return ALPHA * total + BETA * 0.5 * (total**2 - squares)


def exact_g():
    part = 1 / (3 * (1 + G) ** 2)
    variance = np.prod(1 + part) - 1
    return part / variance, part * (variance + 1) / (1 + part) / variance


def exact_morris():
    alone, pair = (ALPHA + 1.5 * BETA) ** 2 / 12, BETA**2 / 144
    variance = 4 * alone + 6 * pair
    first, total = alone / variance, (alone + 3 * pair) / variance
    return np.array([first] * 4 + [0, 0]), np.array([total] * 4 + [0, 0])


def branin(u):
    x, y = 15 * u[0] - 5, 15 * u[1]
    square = y - 5.1 / (4 * np.pi**2) * x**2 + 5 / np.pi * x - 6
    return square**2 + 10 * (1 - 1 / (8 * np.pi)) * np.cos(x) + 10, []


def toy(u):
    a, b = u
    first = 0.5 * np.sin(2 * np.pi * (a * a - 2 * b)) + a + 2 * b - 1.5
    return a + b, [-first, a * a + b * b - 1.5]


def hartmann(u):
    a = np.array([[3, 10, 30], [0.1, 10, 35], [3, 10, 30], [0.1, 10, 35]])
    p = [[0.3689, 0.117, 0.2673], [0.4699, 0.4387, 0.747], [0.1091, 0.8732, 0.5547], [0.0381, 0.5743, 0.8828]]
    return -np.dot([1, 1.2, 3, 3.2], np.exp(-(a * (np.array(u) - p) ** 2).sum(1))), []


def indices():
    cases = [
        ("ishigami", ishigami, 3, 128, ([0.3139, 0.4424, 0], [0.5576, 0.4424, 0.2437])),
        ("g", sobol_g, 5, 256, exact_g()),
        ("morris", morris, 6, 64, exact_morris()),
    ]
    for name, function, inputs, budget, exact in cases:
        problem = {"num_vars": inputs, "names": list(map(str, range(inputs))), "bounds": [[0, 1]] * inputs}
        base = 2 ** int(np.log2(budget // (inputs + 2)))
        errors = []
        for seed in SEEDS:
            points = sample.sample(problem, base, calc_second_order=False, seed=seed)
            found = analyze.analyze(problem, function(points), calc_second_order=False, seed=seed)
            errors.append([abs(found[key] - one).max() for key, one in zip(("S1", "ST"), exact)])
        mean, worst = np.mean(errors, 0), np.max(errors, 0)
        print(f"{name}, {len(points)} runs: largest error of first, total: mean {mean}, worst {worst}")


def searches():
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    cases = [("branin", branin, 2, 0.397887), ("toy", toy, 2, 0.599788), ("hartmann", hartmann, 3, -3.86278)]
    report = "{}, {}: mean {:.5f}, worst {:.5f} above the smallest value".format
    for name, function, inputs, smallest in cases:
        away = []
        for seed in range(1, 6):
            limits = len(function([0.5] * inputs)[1])
            settings = {"cstr_specs": [egobox.CstrSpec.leq(0, tol=0)] * limits} if limits else {}
            search = egobox.Egor([[0, 1]] * inputs, n_doe=8, seed=seed, **settings)

            def rows(points, function=function):
                return np.array([[value, *limits] for value, limits in map(function, points)])

            found = search.minimize(rows, max_iters=32).result.y_doe
            assert len(found) == 40
            away.append(min(row[0] for row in found if all(row[1:] <= 0)) - smallest)
        print(report(name, "egobox", np.mean(away), max(away)))
        for kind in (optuna.samplers.TPESampler, optuna.samplers.GPSampler):
            away = []
            for seed in range(1, 6):
                limited = {"constraints_func": lambda trial: trial.user_attrs["limits"]} if name == "toy" else {}
                study = optuna.create_study(sampler=kind(seed=seed, **limited))

                def objective(trial, function=function, inputs=inputs):
                    value, limits = function([trial.suggest_float(str(i), 0, 1) for i in range(inputs)])
                    trial.set_user_attr("limits", [float(limit) for limit in limits])
                    return float(value)

                study.optimize(objective, n_trials=40)
                kept = [t.value for t in study.trials if all(limit <= 0 for limit in t.user_attrs["limits"])]
                away.append(min(kept) - smallest if kept else np.inf)
            print(report(name, kind.__name__, np.mean(away), max(away)))


if __name__ == "__main__":
    warnings.filterwarnings("ignore")
    indices()
    searches()
