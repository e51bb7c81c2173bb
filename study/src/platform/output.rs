//! The two streams of the program. stderr: lines that never end the program. stdout: what a reader
//! who has closed it does not want any more is dropped.

use std::fmt;
use std::io::{self, Write};

use crate::platform::quote;

/// Characters of a line on stderr, at most (chosen: the longest list of allowed names fits).
const MAX_LINE: usize = 6000;

/// Prints a message and a line feed on stderr, printable ([`quote::printable`]). A stderr that is
/// closed or full loses the message and changes nothing else: the exit code stays that of the command.
pub fn message(text: fmt::Arguments<'_>) {
    let text = quote::cut_lines(&text.to_string(), MAX_LINE);
    // One write, so that lines of several threads do not mix.
    let _ = io::stderr().lock().write_all(format!("{text}\n").as_bytes());
}

/// stdout, or any other stream that its reader may close early (`billow … | head`): the rest is then
/// dropped, and the command ends as it would without a reader.
#[derive(Debug)]
pub struct Output<W> {
    stream: W,
    closed: bool,
}

impl<W: Write> Output<W> {
    /// Output to this stream.
    pub fn new(stream: W) -> Self {
        Self { stream, closed: false }
    }

    /// The result of a write, in which a closed stream is no error.
    fn unless_closed<T>(&mut self, result: io::Result<T>, dropped: T) -> io::Result<T> {
        match result {
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => {
                self.closed = true;
                Ok(dropped)
            }
            other => other,
        }
    }
}

impl<W: Write> Write for Output<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.closed {
            return Ok(bytes.len());
        }
        let written = self.stream.write(bytes);
        self.unless_closed(written, bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        if self.closed {
            return Ok(());
        }
        let flushed = self.stream.flush();
        self.unless_closed(flushed, ())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fails every write in this way.
    struct Failing(io::ErrorKind);

    impl Write for Failing {
        fn write(&mut self, _: &[u8]) -> io::Result<usize> {
            Err(self.0.into())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_closed_stream_is_no_error_and_a_full_one_is() {
        let mut closed = Output::new(Failing(io::ErrorKind::BrokenPipe));
        assert!(closed.write_all(b"rows").and_then(|()| closed.flush()).is_ok());
        assert!(closed.write_all(b"more rows").is_ok());
        let mut full = Output::new(Failing(io::ErrorKind::StorageFull));
        assert!(full.write_all(b"rows").is_err());
    }
}
