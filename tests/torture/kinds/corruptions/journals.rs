//! Damages of the journal.

use std::fs;

use super::target::{
    Damage, Expect, Target, cut, edit_file, fault, faults, flip, harmless, line_of, sealed_again,
    with_other_digit, with_other_number, with_other_text, zero,
};
use crate::harness::journal;
use crate::harness::random::Random;

/// Every damage of a journal.
pub fn all() -> Vec<Damage> {
    let mut all = edits();
    all.extend(lines());
    all.extend(files());
    all
}

/// Edits inside one line.
fn edits() -> Vec<Damage> {
    vec![
        fault("journal: a measure edited", |target, random| {
            target.edit_line(|line| with_other_number(line, "peak_vz", random))
        }),
        fault("journal: final_pressure edited", |target, random| {
            target.edit_line(|line| with_other_number(line, "final_pressure", random))
        }),
        fault("journal: wall time edited", |target, random| {
            target.edit_line(|line| with_other_number(line, "wall_seconds", random))
        }),
        fault("journal: status edited", |target, _| {
            target.edit_line(|line| with_other_text(line, "status", "unstable"))
        }),
        fault("journal: unknown status", |target, _| {
            target.edit_line(|line| with_other_text(line, "status", "finished"))
        }),
        fault("journal: verdict edited", |target, _| {
            target.edit_line(|line| with_other_text(line, "verdict", "deployed"))
        }),
        fault("journal: content hash edited", |target, random| {
            target.edit_line(|line| with_other_digit(line, "content_hash", random))
        }),
        fault("journal: file hash edited", |target, random| {
            target.edit_line(|line| with_other_digit(line, "file_hash", random))
        }),
        fault("journal: file hash removed", |target, _| {
            target.edit_line(|line| with_other_text(line, "file_hash", ""))
        }),
        fault("journal: job id edited", |target, random| {
            target.edit_line(|line| with_other_digit(line, "job", random))
        }),
        fault("journal: id of another job", |target, _| {
            target.edit_line(|line| with_other_text(line, "job", &target.second))
        }),
        fault("journal: checksum edited", |target, random| {
            target.edit_line(|line| with_other_digit(line, "checksum", random))
        }),
        fault("journal: checksum removed", |target, _| {
            target.edit_line(|line| Some(format!("{{{}", line.split_once(',')?.1)))
        }),
        fault("journal: a space put in", |target, _| {
            target.edit_line(|line| Some(line.replacen(",\"", ", \"", 1)))
        }),
        fault("journal: version of an older program, and a number edited", |target, random| {
            edit_header(target, "\"version\":", "\"version\":3,\"old\":")?;
            target.edit_line(|line| with_other_number(line, "peak_vz", random))
        }),
        Damage {
            name: "journal: version of a newer program",
            apply: |target, _| {
                target.edit_lines(|lines| {
                    lines[0] = sealed_again(&lines[0], "\"version\":", "\"version\":9")?;
                    Some(())
                })
            },
            expect: Expect::Newer,
            trials: 1,
        },
    ]
}

fn edit_header(target: &Target, from: &str, to: &str) -> Option<()> {
    target.edit_lines(|lines| {
        lines[0] = lines[0].contains(from).then(|| lines[0].replacen(from, to, 1))?;
        Some(())
    })
}

/// Lines that are missing, doubled, moved or of another job.
fn lines() -> Vec<Damage> {
    vec![
        fault("journal: header removed", |target, _| {
            target.edit_lines(|lines| {
                lines.remove(0);
                Some(())
            })
        }),
        fault("journal: header of another format", |target, _| {
            edit_header(target, "billow-journal", "billow-journey")
        }),
        faults("journal: line cut in its middle", 3, |target, random| {
            target.edit_line(|line| Some(line[..random.below(line.len())].to_owned()))
        }),
        fault("journal: line removed", |target, _| {
            target.edit_lines(|lines| {
                let at = line_of(lines, &target.job)?;
                lines.remove(at);
                Some(())
            })
        }),
        harmless("journal: line doubled", "the same record twice", |target, _| {
            target.edit_lines(|lines| {
                let at = line_of(lines, &target.job)?;
                lines.insert(at, lines[at].clone());
                Some(())
            })
        }),
        harmless("journal: lines swapped", "jobs have no order", |target, _| {
            target.edit_lines(|lines| {
                let (a, b) = (line_of(lines, &target.job)?, line_of(lines, &target.second)?);
                lines.swap(a, b);
                Some(())
            })
        }),
        fault("journal: line of another job in its place", |target, _| {
            target.edit_lines(|lines| {
                let (a, b) = (line_of(lines, &target.job)?, line_of(lines, &target.second)?);
                lines[a] = lines[b].clone();
                Some(())
            })
        }),
        harmless("journal: line of another study", "its job is not in this one", |target, _| {
            let other = journal::paths(&target.other).into_iter().next()?;
            let text = fs::read_to_string(other).ok()?;
            let line = text.lines().find(|line| journal::ended_job(line).is_some())?.to_owned();
            target.edit_lines(|lines| {
                lines.push(line);
                Some(())
            })
        }),
        fault("journal: a line of another program", |target, random| {
            target.edit_lines(|lines| {
                lines.insert(1 + random.below(lines.len()), "not a record".to_owned());
                Some(())
            })
        }),
        fault("journal: two lines joined", |target, _| {
            target.edit_lines(|lines| {
                let at = line_of(lines, &target.job)?;
                let line = lines.remove(at);
                lines[at - 1] += &line;
                Some(())
            })
        }),
    ]
}

/// Damages of a whole file.
fn files() -> Vec<Damage> {
    vec![
        faults("journal: one bit flipped", 8, |target, random| flip(&target.journal()?, random)),
        faults("journal: a block of NUL bytes", 3, |target, random| {
            zero(&target.journal()?, random)
        }),
        faults("journal: cut at a random place", 6, |target, random| {
            // Beyond the lines that hold a record nothing would be lost.
            cut(&target.journal()?, 0.9 * random.fraction())
        }),
        Damage {
            name: "journal: cut after a line",
            apply: cut_after_line,
            expect: Expect::Harmless("the last records may be there"),
            trials: 8,
        },
        fault("journal: empty", |target, _| fs::write(target.journal()?, "").ok()),
        fault("journal: file deleted", |target, _| fs::remove_file(target.journal()?).ok()),
        fault("journal: folder deleted", |target, _| {
            fs::remove_dir_all(target.results.join("journal")).ok()
        }),
        fault("journal: a file in the place of its folder", |target, _| {
            fs::remove_dir_all(target.results.join("journal")).ok()?;
            fs::write(target.results.join("journal"), "x").ok()
        }),
        fault("journal: a byte that is not UTF-8", |target, random| {
            edit_file(&target.journal()?, |bytes| {
                let at = random.below(bytes.len());
                bytes[at] = 0xff;
                Some(())
            })
        }),
        harmless("journal: line ends of Windows", "the text is the same", |target, _| {
            let path = target.journal()?;
            let text = fs::read_to_string(&path).ok()?.replace('\n', "\r\n");
            fs::write(path, text).ok()
        }),
        harmless("journal: copied under a second number", "the same records twice", |target, _| {
            let path = target.journal()?;
            fs::copy(&path, path.with_file_name("000009.jsonl")).ok().map(|_| ())
        }),
        harmless("journal: renamed to another number", "only the order counts", |target, _| {
            let path = target.journal()?;
            fs::rename(&path, path.with_file_name("000007.jsonl")).ok()
        }),
    ]
}

fn cut_after_line(target: &Target, random: &mut Random) -> Option<()> {
    target.edit_lines(|lines| {
        let kept = 1 + random.below(lines.len() - 1);
        lines.truncate(kept);
        Some(())
    })
}
