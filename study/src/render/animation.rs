//! Shapes of one run as an animated GIF, or as a film by ffmpeg where it is installed.

use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

use super::png::Pixels;

/// Pictures in a second. A GIF counts hundredths of a second, so that 24 would drift.
pub const PER_SECOND: u16 = 25;
/// How well colours are chosen, 1 the best and slowest. Chosen: shading has no visible steps.
const COLOUR_SPEED: i32 = 10;

/// The bytes of a GIF of these pictures, which have one size; it repeats without end.
///
/// # Errors
/// A picture that is too large for a GIF, or an error of the pictures.
pub fn gif(pictures: impl Iterator<Item = Result<Pixels, String>>) -> Result<Vec<u8>, String> {
    let mut pictures = pictures.peekable();
    let text = |error: &dyn std::fmt::Display| error.to_string();
    let (width, height) = match pictures.peek() {
        Some(Ok(first)) => (first.width, first.height),
        _ => (1, 1),
    };
    let size = |length: u32| u16::try_from(length).map_err(|_| "too large for a GIF".to_owned());
    let (columns, rows) = (size(width)?, size(height)?);
    let mut encoder =
        gif::Encoder::new(Vec::new(), columns, rows, &[]).map_err(|error| text(&error))?;
    encoder.set_repeat(gif::Repeat::Infinite).map_err(|error| text(&error))?;
    for picture in pictures {
        let mut rgba = picture?.rgba;
        let mut frame = gif::Frame::from_rgba_speed(columns, rows, &mut rgba, COLOUR_SPEED);
        frame.delay = 100 / PER_SECOND;
        encoder.write_frame(&frame).map_err(|error| text(&error))?;
    }
    encoder.into_inner().map_err(|error| text(&error))
}

/// Writes a `WebM` film of these pictures by the program ffmpeg.
///
/// # Errors
/// No ffmpeg, or what it says; an error of the pictures.
pub fn webm(
    pictures: impl Iterator<Item = Result<Pixels, String>>,
    path: &Path,
) -> Result<(), String> {
    let mut running = None;
    for picture in pictures {
        let Pixels { width, height, rgba } = match picture {
            Ok(picture) => picture,
            Err(problem) => {
                if let Some(mut ffmpeg) = running.take() {
                    // The pictures failed, not ffmpeg.
                    let _ = std::process::Child::kill(&mut ffmpeg);
                    let _ = ffmpeg.wait();
                }
                return Err(problem);
            }
        };
        if running.is_none() {
            running = Some(ffmpeg(width, height, path)?);
        }
        let input = running.as_mut().and_then(|ffmpeg| ffmpeg.stdin.as_mut());
        if input.is_some_and(|input| input.write_all(&rgba).is_err()) {
            // It ended; its own words say why.
            break;
        }
    }
    let Some(ffmpeg) = running else { return Err("no pictures".to_owned()) };
    let output = ffmpeg.wait_with_output().map_err(|error| error.to_string())?;
    if output.status.success() {
        return Ok(());
    }
    Err(format!("ffmpeg: {}", String::from_utf8_lossy(&output.stderr).trim()))
}

fn ffmpeg(width: u32, height: u32, path: &Path) -> Result<std::process::Child, String> {
    let size = format!("{width}x{height}");
    let rate = PER_SECOND.to_string();
    Command::new("ffmpeg")
        .args(["-y", "-loglevel", "error", "-f", "rawvideo", "-pixel_format", "rgba"])
        .args(["-video_size", &size, "-framerate", &rate, "-i", "pipe:0"])
        // The format needs even sizes.
        .args(["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p"])
        .args(["-c:v", "libvpx-vp9", "-b:v", "0", "-crf", "30", "-f", "webm"])
        .arg(path)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|error| {
            format!(
                "the program ffmpeg cannot be started: {error}\n  next: install it, or write a .gif"
            )
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gif_has_its_pictures_and_their_delay() {
        let picture = |grey: u8| {
            let rgba = [[grey, grey, grey, 255]; 6].concat();
            Ok(Pixels { width: 3, height: 2, rgba })
        };
        let bytes = gif([0, 128, 255].into_iter().map(picture)).unwrap();
        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::RGBA);
        let mut decoder = options.read_info(bytes.as_slice()).unwrap();
        let mut greys = Vec::new();
        while let Some(frame) = decoder.read_next_frame().unwrap() {
            assert_eq!((frame.width, frame.height, frame.delay), (3, 2, 4));
            greys.push(frame.buffer[0]);
        }
        assert_eq!(greys, [0, 128, 255]);
        let wide = Pixels { width: 70_000, height: 1, rgba: vec![0; 280_000] };
        assert!(gif(std::iter::once(Ok(wide))).unwrap_err().contains("too large"));
        assert_eq!(gif(std::iter::once(Err("why".to_owned()))).unwrap_err(), "why");
    }
}
