//! Time and memory as Slurm writes them.
//!
//! ```text
//! minutes:seconds, hours:minutes:seconds, days-hours, days-hours:minutes, days-hours:minutes:seconds
//! a whole number with K, M, G or T:   1024, 1024², 1024³, 1024⁴ bytes
//! ```
//! A number alone, minutes or megabytes to Slurm, is not read: it could be anything.

/// A time in seconds; `None` for another notation.
pub fn time(text: &str) -> Option<f64> {
    let (days, rest) = match text.split_once('-') {
        Some((days, rest)) => (Some(whole(days)?), rest),
        None => (None, text),
    };
    let parts: Vec<u64> = rest.split(':').map(whole).collect::<Option<_>>()?;
    let seconds = match (days, parts.as_slice()) {
        (None, [minutes, seconds]) => 60 * minutes + seconds,
        (None, [hours, minutes, seconds]) => 3600 * hours + 60 * minutes + seconds,
        (Some(days), [hours, rest @ ..]) if rest.len() <= 2 => {
            let minutes = rest.first().unwrap_or(&0);
            let seconds = rest.get(1).unwrap_or(&0);
            86400 * days + 3600 * hours + 60 * minutes + seconds
        }
        _ => return None,
    };
    Some(seconds as f64)
}

/// A size of memory in bytes; `None` for another notation.
pub fn memory(text: &str) -> Option<f64> {
    const KIB: f64 = 1024.0;
    let factor = match text.chars().next_back()?.to_ascii_uppercase() {
        'K' => KIB,
        'M' => KIB * KIB,
        'G' => KIB * KIB * KIB,
        'T' => KIB * KIB * KIB * KIB,
        _ => return None,
    };
    let number = whole(&text[..text.len() - 1])?;
    Some(number as f64 * factor)
}

/// A whole number of at most nine digits.
fn whole(text: &str) -> Option<u64> {
    let is_whole = (1..=9).contains(&text.len()) && text.bytes().all(|byte| byte.is_ascii_digit());
    if is_whole { text.parse().ok() } else { None }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_read_as_slurm_reads_them() {
        for (text, seconds) in [
            ("90:00", 5400.0),
            ("2:00:30", 7230.0),
            ("1-0", 86400.0),
            ("1-12:30", 131_400.0),
            ("2-00:00:05", 172_805.0),
        ] {
            assert_eq!(time(text), Some(seconds), "{text}");
        }
        for text in
            ["", "60", "2 h", "-1", "1-", ":30", "1::2", "1:2:3:4", "1-2:3:4:5", "1:2.5", "é:1"]
        {
            assert_eq!(time(text), None, "{text}");
        }
    }

    #[test]
    fn memory_is_read_as_slurm_reads_it() {
        for (text, bytes) in
            [("512M", 536_870_912.0), ("4G", 4_294_967_296.0), ("1t", 1.099_511_627_776e12)]
        {
            assert_eq!(memory(text), Some(bytes), "{text}");
        }
        for text in ["", "G", "4", "4 G", "4GB", "-4G", "1.5G", "4é"] {
            assert_eq!(memory(text), None, "{text}");
        }
    }
}
