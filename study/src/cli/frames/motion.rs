//! The motion of a job in slow motion, and shapes as models of other programs.

use std::path::Path;

use billow_solver::output::frames::Frame;
use rayon::prelude::*;

use super::Args;
use crate::cli::picture::refused;
use crate::platform::error::{Error, Result};
use crate::platform::files::{Disk, Files, disk_error, write_output};
use crate::render::filmstrip::Filmstrip;
use crate::render::{animation, model, png};
use crate::store::history_file::StoredFrames;

/// Time that a motion takes to watch, s.
const SECONDS: u16 = 8;
/// Pixels per mm of its pictures. Chosen: 630 pixels across.
const DOTS_PER_MM: f64 = 3.5;
/// Pictures that are drawn together, on all cores. Chosen: they take 20 MB.
const AT_ONCE: usize = 16;

/// A model of another program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Model {
    /// Wavefront OBJ.
    Obj,
    /// Binary STL.
    Stl,
    /// Binary glTF with the motion.
    Glb,
}

impl Model {
    /// The model that the end of a file name names; `None` for another one.
    pub(super) fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_string_lossy().to_lowercase();
        match extension.as_str() {
            "obj" => Some(Self::Obj),
            "stl" => Some(Self::Stl),
            "glb" => Some(Self::Glb),
            _ => None,
        }
    }

    /// The model that the options ask for; `None` where they ask for pictures.
    ///
    /// # Errors
    /// [`Error::Input`] for options that are not of it.
    pub(super) fn asked(args: &Args) -> Result<Option<Self>> {
        let Some(model) = args.out.as_deref().and_then(Self::of) else { return Ok(None) };
        let times = args.times.join(",");
        if model == Self::Glb && !args.times.is_empty() {
            return Err(refused(
                "--times",
                &times,
                "a motion has every stored shape",
                "no --times",
            ));
        }
        if args.times.len() > 1 {
            return Err(refused("--times", &times, "several times for one shape", "one time"));
        }
        if args.smooth || args.colour.is_some() {
            let option = if args.smooth { "--smooth" } else { "--colour" };
            let allowed = "a file name of a picture";
            return Err(refused(option, "", "is for pictures, not for a model", allowed));
        }
        Ok(Some(model))
    }

    /// The bytes of the file of these frames, at least one.
    ///
    /// # Errors
    /// What the writer says.
    pub(super) fn bytes(
        self,
        stored: &StoredFrames,
        frames: &[Frame],
        title: &str,
    ) -> std::result::Result<Vec<u8>, String> {
        let (triangles, storeys) = (stored.triangles(), stored.storeys());
        match self {
            Self::Obj => Ok(model::obj(triangles, storeys, &frames[0], title).into_bytes()),
            Self::Stl => model::stl(triangles, &frames[0]),
            Self::Glb => Ok(model::glb(triangles, storeys, frames, f64::from(SECONDS), title)),
        }
    }
}

/// A film of the motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Film {
    /// Animated GIF.
    Gif,
    /// `WebM`, by ffmpeg.
    Webm,
}

impl Film {
    /// The film that the end of a file name names.
    ///
    /// # Errors
    /// [`Error::Input`] for another one.
    pub(super) fn of(path: &Path) -> Result<Self> {
        let extension = path.extension().map(|end| end.to_string_lossy().to_lowercase());
        match extension.as_deref() {
            Some("gif") => Ok(Self::Gif),
            Some("webm") => Ok(Self::Webm),
            _ => {
                let allowed = "a file name that ends in .gif or .webm";
                Err(refused("--animate", &path.display().to_string(), "not a film", allowed))
            }
        }
    }

    /// Draws every frame of the strip and writes the film.
    ///
    /// # Errors
    /// A file that cannot be written; no ffmpeg.
    pub(super) fn write(self, strip: &Filmstrip<'_>, path: &Path) -> Result<()> {
        let svgs: Vec<String> = strip.pictures().collect();
        let pictures = svgs.chunks(AT_ONCE).flat_map(|some| -> Vec<_> {
            some.par_iter().map(|svg| png::pixels(svg, DOTS_PER_MM)).collect()
        });
        let failed = |problem| Error::Disk { path: path.to_owned(), problem };
        match self {
            Self::Gif => {
                let bytes = animation::gif(pictures).map_err(failed)?;
                write_output(&Disk, path, &bytes).map_err(|error| disk_error(path, &error))
            }
            Self::Webm => {
                // ffmpeg writes beside the file, which is then complete or not there.
                let name = path.file_name().unwrap_or_default().to_string_lossy();
                let part = path.with_file_name(format!(".{name}.part"));
                let made = animation::webm(pictures, &part).map_err(failed);
                let bytes =
                    made.and_then(|()| Disk.read(&part).map_err(|error| disk_error(&part, &error)));
                let _ = Disk.remove(&part);
                write_output(&Disk, path, &bytes?).map_err(|error| disk_error(path, &error))
            }
        }
    }
}

/// Frames at equal times from the first to the last one, linear between those that are stored.
pub(super) fn slow(stored: &[Frame]) -> Vec<Frame> {
    let count = usize::from(SECONDS * animation::PER_SECOND);
    let (first, last) = (stored[0].time, stored[stored.len() - 1].time);
    let step = (last - first) / count as f64;
    if step <= 0.0 {
        return stored.to_vec();
    }
    let mut after = 1;
    let mut frames = Vec::with_capacity(count + 1);
    for number in 0..=count {
        let time = first + step * number as f64;
        while after < stored.len() - 1 && stored[after].time < time {
            after += 1;
        }
        let [a, b] = [&stored[after - 1], &stored[after]];
        let length = b.time - a.time;
        let part = if length > 0.0 { ((time - a.time) / length).clamp(0.0, 1.0) } else { 0.0 };
        frames.push(between(a, b, part, time));
    }
    frames
}

fn mixed<const N: usize>(
    from: &[[f32; N]],
    to: &[[f32; N]],
    mix: impl Fn(f32, f32) -> f32,
) -> Vec<[f32; N]> {
    let pairs = from.iter().zip(to);
    pairs.map(|(a, b)| std::array::from_fn(|k| mix(a[k], b[k]))).collect()
}

/// A frame at a part of the time from one to another.
#[expect(clippy::cast_possible_truncation, reason = "frames are in single precision")]
fn between(a: &Frame, b: &Frame, part: f64, time: f64) -> Frame {
    let part32 = part as f32;
    let mix = |from: f32, to: f32| from + part32 * (to - from);
    Frame {
        time,
        positions: mixed(&a.positions, &b.positions, mix),
        velocities: mixed(&a.velocities, &b.velocities, mix),
        stresses: mixed(&a.stresses, &b.stresses, mix),
        regimes: if part < 0.5 { a.regimes.clone() } else { b.regimes.clone() },
        gaps: a.gaps.iter().zip(&b.gaps).map(|(a, b)| mix(*a, *b)).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slow_motion_has_equal_times_and_the_stored_shapes() {
        let frame = |time: f64, x: f32| Frame { time, positions: vec![[x; 3]], ..Frame::default() };
        let stored = [frame(0.0, 0.0), frame(0.1, 1.0), frame(0.4, 4.0)];
        let slow = slow(&stored);
        assert_eq!(slow.len(), 201);
        for frame in &slow {
            assert!((f64::from(frame.positions[0][0]) - 10.0 * frame.time).abs() < 1e-5);
        }
        assert!((slow[200].time - 0.4).abs() < 1e-12);
        assert_eq!(super::slow(&stored[..1]).len(), 1);
    }

    #[test]
    fn a_file_name_says_what_is_written() {
        assert_eq!(Model::of(Path::new("a.GLB")), Some(Model::Glb));
        assert_eq!(Model::of(Path::new("a.svg")), None);
        assert_eq!(Film::of(Path::new("a.gif")).unwrap(), Film::Gif);
        assert!(Film::of(Path::new("a.mp4")).unwrap_err().to_string().contains(".webm"));
    }
}
