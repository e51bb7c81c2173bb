//! The reference page of the columns, docs/reference/columns.md: written from the tables in the code.

use std::fmt::Write as _;

use billow_solver::models::film::{CONTACT_COLUMNS, FILM_STRESS_99, PLEAT_COLUMNS};
use billow_solver::models::run::FILM_SPEED;
use billow_solver::output::history::{COLUMNS as HISTORY_COLUMNS, HEIGHT, RING_COLUMNS};

use super::extrapolated::{EXTRAPOLATED, EXTRAPOLATED_ERROR_MEANING, EXTRAPOLATED_ERRORS};
use crate::accuracy::{NO_ERROR_REASON, NO_ERROR_REASON_MEANING, PROMISED};
use crate::job::row::{
    BetterSide, COLUMNS, CellType, DERIVED_COLUMNS, RowColumn, SAME_JOB_AS, SAME_JOB_AS_MEANING,
};
use crate::job::status::Status;

/// The text of the page, Markdown.
pub fn page() -> String {
    let mut page = String::from(
        "# Columns\n\n\
         This page is generated from the tables in the code. A test fails when it is not current.\n\
         All values are in SI units; the unit 1 marks a dimensionless number.\n\n",
    );
    table_columns(&mut page);
    statuses(&mut page);
    history_columns(&mut page);
    page
}

fn table_columns(page: &mut String) {
    page.push_str(
        "## Summary table\n\n\
         `summary.parquet`, `billow table`, `billow job --all`, `billow chart --measure`.\n\n\
         The first column is `job`, the job id. The parameters of the study follow, then the columns\n\
         below. A parameter keeps its name when a column below has the same one; that column is then\n\
         called `<name>_resolved`. Points that are one job are rows with the same `job`; `same_job_as` lists\n\
         them. `safe`, `smallest_margin`, `smallest_margin_of` and `margin_<measure>` exist in a study with\n\
         `limits`, `verdict_depends_on` in one that varies a numerical choice. With `solver.meshes` the promised\n\
         measures (those with an error) and the times since the release have `<measure>_extrapolated`, and a row of `billow table` without `--runs`\n\
         has these values as its measures.\n\
         Any cell may be null. The column \"better\" says which side\n\
         `billow compare` calls the better one. Marks: a \"signed\" value can be negative or zero and is\n\
         compared by difference, not by ratio; a \"noisy\" measure changes by more than 3 % with the seed,\n\
         the time step, the numerical damping or the contact distance: compare it over several seeds.\n\n\
         | name | type | unit | group | better | marks | meaning |\n\
         |---|---|---|---|---|---|---|\n",
    );
    for column in COLUMNS {
        let better = match column.better {
            BetterSide::Smaller => "smaller",
            BetterSide::Larger => "larger",
            BetterSide::Neither => "",
        };
        let _ = writeln!(
            page,
            "| `{}` | {} | {} | {} | {better} | {} | {} |",
            column.name,
            column.cell_type.name(),
            column.unit,
            column.group.name(),
            marks(column),
            column.meaning
        );
    }
    for column in &DERIVED_COLUMNS {
        let (name, cell_type, unit) = (column.name, column.cell_type.name(), column.unit);
        let _ = writeln!(page, "| `{name}` | {cell_type} | {unit} |  |  |  | {} |", column.meaning);
    }
    let text = CellType::Text.name();
    let number = CellType::Number.name();
    let _ = writeln!(
        page,
        "| `margin_<measure>` | {number} | 1 |  |  |  | distance of a measure from its limit over the limit; negative \
         beyond it |"
    );
    let [first, ..] = &PROMISED;
    for (name, meaning) in first.columns() {
        let [name, meaning] =
            [name, &meaning].map(|text| text.replace(first.measure.name(), "<measure>"));
        let _ = writeln!(page, "| `{name}` | {number} | of the measure |  |  |  | {meaning} |");
    }
    let of_meshes = [
        (
            EXTRAPOLATED,
            "extrapolated from the meshes of a study with `solver.meshes`; that of the finest where the next one has none",
        ),
        (EXTRAPOLATED_ERRORS[0], EXTRAPOLATED_ERROR_MEANING),
        (EXTRAPOLATED_ERRORS[1], EXTRAPOLATED_ERROR_MEANING),
    ];
    for (end, meaning) in of_meshes {
        let _ =
            writeln!(page, "| `<measure>{end}` | {number} | of the measure |  |  |  | {meaning} |");
    }
    let _ =
        writeln!(page, "| `{NO_ERROR_REASON}` | {text} |  |  |  |  | {NO_ERROR_REASON_MEANING} |");
    let _ = writeln!(page, "| `{SAME_JOB_AS}` | {text} |  |  |  |  | {SAME_JOB_AS_MEANING} |");
}

/// What `billow compare` and a reader must know of a column: signed, noisy.
fn marks(column: &RowColumn) -> String {
    let marks = [(column.signed, "signed"), (column.id.is_noisy(), "noisy")];
    let set: Vec<&str> = marks.iter().filter(|(holds, _)| *holds).map(|(_, name)| *name).collect();
    set.join(", ")
}

fn statuses(page: &mut String) {
    let in_tables = Status::all().filter(|status| match status {
        Status::Cancelled | Status::Paused | Status::NoEquilibrium => false,
        Status::Pending
        | Status::Done
        | Status::Infeasible
        | Status::Invalid
        | Status::Panicked
        | Status::Timeout
        | Status::OutOfMemory
        | Status::Crashed
        | Status::Failed(_) => true,
    });
    let names: Vec<String> = in_tables.map(|status| format!("`{status}`")).collect();
    let _ = write!(
        page,
        "\nValues of `status`: {}.\n\
         The run of a single scene (`billow solve`) can also be `paused` or `no_equilibrium`.\n",
        names.join(", ")
    );
}

fn history_columns(page: &mut String) {
    page.push_str(
        "\n## History\n\n\
         Group `history` of a job's HDF5 file, `billow job --history`, `billow chart --history`.\n\
         Every column has one value per sample.\n\n\
         | name | unit | present | meaning |\n\
         |---|---|---|---|\n",
    );
    for column in HISTORY_COLUMNS {
        let present = match column.name {
            HEIGHT => "film without rings",
            name if RING_COLUMNS.contains(&name) => "film with rings",
            _ => "always",
        };
        let _ = writeln!(
            page,
            "| `{}` | {} | {present} | {} |",
            column.name, column.unit, column.meaning
        );
    }
    let _ = writeln!(
        page,
        "| `vz_centre` | m/s | film with rings | velocity of the top centre node along z |"
    );
    for ((name, unit, meaning), present) in
        [(FILM_STRESS_99, "film"), (FILM_SPEED, "film and storeys")]
    {
        let _ = writeln!(page, "| `{name}` | {unit} | {present} | {meaning} |");
    }
    for (name, unit, meaning) in CONTACT_COLUMNS {
        let _ = writeln!(page, "| `{name}` | {unit} | film with contact | {meaning} |");
    }
    for (name, unit, meaning) in PLEAT_COLUMNS {
        let _ = writeln!(page, "| `{name}` | {unit} | capsule with gas and contact | {meaning} |");
    }
    page.push_str(
        "| `plate_NAME_force` | N | each plate of a scene | force of the film on the plate along its \
         normal, against it |\n\
         | `node_NAME_x`, `_y`, `_z` | m | each followed node of a scene | position of the node |\n\
         | `element_NAME_N1`, `_N2` | N/m | each followed element of a scene | principal membrane \
         force per reference width |\n",
    );
}
