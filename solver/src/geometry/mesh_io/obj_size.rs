//! Counts the vertices and elements of an OBJ text part by part, before anything of it is kept.

/// Counts so far. Feed the text with [`Self::add`]; parts may end anywhere.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ObjSize {
    /// Number of bytes.
    pub bytes: u64,
    /// Number of lines.
    pub lines: u64,
    /// Lines `v`.
    pub vertices: u64,
    /// Lines `f`.
    pub faces: u64,
    /// Triangles of their fans. A line continued after a `\` counts too few.
    pub elements: u64,
    place: Place,
    /// Words of a face so far.
    words: u64,
}

/// Where in a line the text so far ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum Place {
    /// Before the first word.
    #[default]
    Start,
    /// After a first letter that may be a keyword of one letter.
    Keyword(u8),
    /// Between two words of a face.
    Space,
    /// In a word of a face.
    Word,
    /// In a line, or a part of it, that does not count.
    Ignored,
}

impl ObjSize {
    /// Counts the next part of the text.
    pub fn add(&mut self, part: &[u8]) {
        self.bytes += part.len() as u64;
        for byte in part {
            self.place = match (self.place, byte) {
                (_, b'\n') => {
                    self.end_line();
                    Place::Start
                }
                (Place::Start, b' ' | b'\t' | b'\r') => Place::Start,
                (Place::Start, b'v' | b'f') => Place::Keyword(*byte),
                (Place::Keyword(b'v'), b' ' | b'\t') => {
                    self.vertices += 1;
                    Place::Ignored
                }
                (Place::Keyword(b'f'), b' ' | b'\t') => {
                    self.faces += 1;
                    Place::Space
                }
                (Place::Space | Place::Word, b' ' | b'\t' | b'\r') => Place::Space,
                (Place::Space, byte) if !is_end(*byte) => {
                    self.words += 1;
                    Place::Word
                }
                (Place::Word, byte) if !is_end(*byte) => Place::Word,
                _ => Place::Ignored,
            };
        }
    }

    /// The counts, with a last line that has no line end.
    #[must_use]
    pub fn finish(mut self) -> Self {
        if self.place != Place::Start {
            self.end_line();
        }
        self
    }

    fn end_line(&mut self) {
        self.lines += 1;
        self.elements += self.words.saturating_sub(2);
        self.words = 0;
        self.place = Place::Start;
    }
}

/// Whether a byte ends the numbers of a line: a comment, or a continuation.
fn is_end(byte: u8) -> bool {
    matches!(byte, b'#' | b'\\')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_faces_and_elements_are_counted_at_any_end_of_a_part() {
        let text = b"# f 1 2 3\nv 0 0 0\n  v 1 0 0\r\nvn 0 0 1\nf 1/1 2/2 3/3 4/4 # x y\r\nf\t1 2 3\ng f 1 2\n";
        for length in 1..text.len() {
            let mut size = ObjSize::default();
            text.chunks(length).for_each(|part| size.add(part));
            let size = size.finish();
            assert_eq!((size.vertices, size.faces, size.elements), (2, 2, 3), "{length}");
            assert_eq!((size.bytes, size.lines), (text.len() as u64, 7));
        }
        let mut last = ObjSize::default();
        last.add(b"f 1 2 3");
        assert_eq!(last.finish().elements, 1);
        assert_eq!(ObjSize::default().finish().lines, 0);
    }
}
