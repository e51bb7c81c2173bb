//! The scripts of a submission.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use crate::store::results::{PARTS, SUBMISSION};

/// Time before the end of its wall time at which a task is asked to stop, s. Chosen: far more than the 2 s that a run takes
/// to stop; Slurm may ask up to a minute earlier.
const WARNING: u32 = 60;

/// What the tasks of a submission need.
#[derive(Debug, Clone, PartialEq)]
pub struct Needs {
    /// Wall time of a task, s.
    pub wall_time: f64,
    /// Cores of a task.
    pub cores: usize,
    /// Memory of a task, bytes.
    pub memory: u64,
    /// Further options of `sbatch`, as in `--account=film`.
    pub options: Vec<String>,
}

/// A submission whose scripts are wanted.
#[derive(Debug, Clone, PartialEq)]
pub struct Scripts<'a> {
    /// The program, with its path.
    pub program: PathBuf,
    /// The results folder, with its path.
    pub root: PathBuf,
    /// Name of the study.
    pub study: &'a str,
    /// Number of tasks.
    pub tasks: usize,
    /// What a task needs.
    pub needs: &'a Needs,
}

impl Scripts<'_> {
    /// The script of the tasks.
    pub fn array(&self) -> String {
        let Needs { wall_time, cores, memory, .. } = self.needs;
        let mut text = self.head("", *wall_time, *cores, *memory, "task-%a.txt");
        let _ = writeln!(text, "#SBATCH --array=1-{}", self.tasks);
        // The signal goes to the shell of the script, which the program replaces.
        let _ = writeln!(text, "#SBATCH --signal=B:USR1@{WARNING}");
        text += "#SBATCH --requeue\n\n";
        text += "# Each task runs one part of the jobs. What it does not finish is in the next submission.\n";
        let (root, tasks) = (quoted(&self.root), self.tasks);
        let _ = writeln!(
            text,
            "exec {} run {root} --points \"$SLURM_ARRAY_TASK_ID/{tasks}\" \\\n  --results \
             {root}/{PARTS}/\"$SLURM_ARRAY_TASK_ID-{tasks}\" --threads {cores} --quiet",
            quoted(&self.program),
        );
        text
    }

    /// The script that ends the study.
    pub fn merge(&self) -> String {
        const MEMORY: u64 = 2_000_000_000;
        let memory = self.needs.memory.max(MEMORY);
        let mut text = self.head("-merge", self.needs.wall_time, 1, memory, "merge.txt");
        text += "\n# Joins the results of the tasks, when all have ended.\n";
        let _ = writeln!(text, "exec {} merge {}", quoted(&self.program), quoted(&self.root));
        text
    }

    fn head(&self, end: &str, wall_time: f64, cores: usize, memory: u64, output: &str) -> String {
        let folder = self.root.join(SUBMISSION);
        let name: String = self
            .study
            .chars()
            .map(|letter| if letter.is_ascii_alphanumeric() { letter } else { '_' })
            .collect();
        let mut text = String::from("#!/bin/bash\n");
        let mut option = |name: &str, value: &str| {
            let _ = writeln!(text, "#SBATCH {name}={value}");
        };
        option("--job-name", &format!("billow-{name}{end}"));
        option("--output", &quoted(&folder.join(output)));
        option("--open-mode", "append");
        option("--ntasks", "1");
        option("--cpus-per-task", &cores.to_string());
        option("--mem", &format!("{}M", memory.div_ceil(1 << 20)));
        option("--time", &slurm_time(wall_time));
        for option in &self.needs.options {
            let _ = writeln!(text, "#SBATCH {option}");
        }
        text
    }
}

/// A time (s) as Slurm reads it, rounded up: "1-02:30:00", "00:05:00".
fn slurm_time(seconds: f64) -> String {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "positive, and saturates"
    )]
    let seconds = libm::ceil(seconds) as u64;
    let (days, rest) = (seconds / 86_400, seconds % 86_400);
    let clock = format!("{:02}:{:02}:{:02}", rest / 3600, rest / 60 % 60, rest % 60);
    if days > 0 { format!("{days}-{clock}") } else { clock }
}

/// A path as one word of the shell.
fn quoted(path: &Path) -> String {
    let text = path.display().to_string();
    let is_plain = |letter: char| letter.is_ascii_alphanumeric() || "/._-+=%".contains(letter);
    if text.chars().all(is_plain) {
        return text;
    }
    format!("'{}'", text.replace('\'', "'\\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn needs() -> Needs {
        Needs {
            wall_time: 5400.0,
            cores: 2,
            memory: 3 << 30,
            options: vec!["--account=film".to_owned(), "--partition=short".to_owned()],
        }
    }

    #[test]
    fn a_task_runs_its_part_and_is_asked_to_stop_in_time() {
        let needs = needs();
        let scripts = Scripts {
            program: "/opt/billow/billow".into(),
            root: "/data/my study".into(),
            study: "my study",
            tasks: 12,
            needs: &needs,
        };
        let text = scripts.array();
        for line in [
            "#!/bin/bash",
            "#SBATCH --job-name=billow-my_study",
            "#SBATCH --array=1-12",
            "#SBATCH --cpus-per-task=2",
            "#SBATCH --mem=3072M",
            "#SBATCH --time=01:30:00",
            "#SBATCH --partition=short",
            "#SBATCH --account=film",
            "#SBATCH --signal=B:USR1@60",
            "exec /opt/billow/billow run '/data/my study' --points \"$SLURM_ARRAY_TASK_ID/12\" \\",
            "  --results '/data/my study'/parts/\"$SLURM_ARRAY_TASK_ID-12\" --threads 2 --quiet",
        ] {
            assert!(text.lines().any(|found| found == line), "{line}\n{text}");
        }
        // The first line that is no comment ends the options.
        let command = text.find("exec").unwrap();
        assert!(!text[command..].contains("#SBATCH"));
        let merge = scripts.merge();
        assert!(merge.ends_with("exec /opt/billow/billow merge '/data/my study'\n"), "{merge}");
        assert!(!merge.contains("--array") && merge.contains("#SBATCH --partition=short"));
    }

    #[test]
    fn times_and_paths_are_written_as_slurm_and_the_shell_read_them() {
        assert_eq!(slurm_time(59.2), "00:01:00");
        assert_eq!(slurm_time(93_784.0), "1-02:03:04");
        assert_eq!(quoted(Path::new("/a/b-1.x")), "/a/b-1.x");
        assert_eq!(quoted(Path::new("/a b/it's$")), "'/a b/it'\\''s$'");
    }
}
