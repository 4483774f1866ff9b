//! Poses and cameras of COLMAP: `images.txt` and `cameras.txt` in a folder, or the same as `.bin`, which take precedence.
//!
//! An image has the rotation R (a unit quaternion w, x, y, z) and the translation t from the world to its camera, which looks along +z
//! with y down; so its eye is −Rᵀ t, and right, up and forward are the rows x, −y and z of R. A camera of focal length f and a width of w
//! pixels has the horizontal field of view 2 atan(w / 2f). Formats: <https://colmap.github.io/format.html>. Lenses with distortion are
//! refused: `colmap image_undistorter` removes it.

use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use glam::{DMat3, DQuat, DVec3};

use super::open::open_regular;
use crate::error::{Error, Result};

/// The number of bytes of a line or a name that are kept.
const LONGEST: usize = 1 << 12;
/// The largest number of parameters of a camera.
const MOST: usize = 12;

/// Models of cameras by number: name, parameters, and how many of these are focal lengths.
const MODELS: [(&str, usize, usize); 11] = [
    ("SIMPLE_PINHOLE", 3, 1),
    ("PINHOLE", 4, 2),
    ("SIMPLE_RADIAL", 4, 1),
    ("RADIAL", 5, 1),
    ("OPENCV", 8, 2),
    ("OPENCV_FISHEYE", 8, 2),
    ("FULL_OPENCV", 12, 2),
    ("FOV", 5, 2),
    ("SIMPLE_RADIAL_FISHEYE", 4, 1),
    ("RADIAL_FISHEYE", 5, 1),
    ("THIN_PRISM_FISHEYE", 12, 2),
];

/// The pose of an image, and its camera.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ColmapPose {
    /// The pinhole, in the units of the reconstruction.
    pub eye: DVec3,
    /// Orthonormal: right, up, forward.
    pub axes: [DVec3; 3],
    /// Its camera.
    pub picture: ColmapPicture,
}

/// The pictures of a camera without distortion, in pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ColmapPicture {
    /// Columns and rows.
    pub size: [f64; 2],
    /// The principal point, from the upper left corner.
    pub centre: [f64; 2],
    /// The focal length.
    pub focal: f64,
}

impl ColmapPicture {
    /// Horizontal and vertical field of view, radians, of a film of this size whose middle is the principal point.
    pub fn fov(&self, film: [f64; 2]) -> [f64; 2] {
        film.map(|size| 2.0 * libm::atan2(0.5 * size, self.focal))
    }

    /// Whether the principal point of a picture at `offset` on a film is the middle of that film, to half a pixel.
    pub fn is_centred(&self, film: [f64; 2], offset: [f64; 2]) -> bool {
        (0..2).all(|axis| (0.5 * film[axis] - offset[axis] - self.centre[axis]).abs() <= 0.5)
    }

    /// The smallest film whose middle is the principal point, to a quarter of a pixel, and which has the picture at an offset on it.
    pub fn film(&self) -> [[f64; 2]; 2] {
        let doubled = self.centre.map(|centre| (2.0 * centre).round());
        let film = [0, 1].map(|axis| doubled[axis].max(2.0 * self.size[axis] - doubled[axis]));
        [film, [0, 1].map(|axis| 0.5 * (film[axis] - doubled[axis]))]
    }
}

/// An image of a reconstruction.
struct Image {
    rotation: DQuat,
    translation: DVec3,
    camera: u32,
}

/// The pose of the image of this name in the reconstruction in `folder`.
///
/// # Errors
/// The files cannot be read or are broken; there is no such image; its camera is not a pinhole with square pixels.
pub fn pose(folder: &Path, image: &str) -> Result<ColmapPose> {
    // The image names its camera, so images are read first.
    let (images, is_binary) = file(folder, "images")?;
    let found = match is_binary {
        true => binary_image(&images, image)?,
        false => text_image(&images, image)?,
    };
    let (cameras, is_binary) = file(folder, "cameras")?;
    let picture = match is_binary {
        true => binary_camera(&cameras, found.camera)?,
        false => text_camera(&cameras, found.camera)?,
    };
    // A rotation is a unit quaternion; numbers this far from length 1 are not one.
    let length = found.rotation.length();
    if !((length - 1.0).abs() < 1e-3 && found.translation.is_finite()) {
        let what = format!("the pose of {image:?} is not a rotation and translation");
        return Err(broken(&images, what));
    }
    // x_camera = R x + t with y down: rows of R are the camera's axes in the world.
    let rotation = DMat3::from_quat(found.rotation.normalize());
    let [right, down, forward] = [0, 1, 2].map(|row| rotation.row(row));
    Ok(ColmapPose {
        eye: -(rotation.transpose() * found.translation),
        axes: [right, -down, forward],
        picture,
    })
}

/// The files of a reconstruction in `folder` that [`pose`] reads.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let found = ["images", "cameras"].map(|name| file(folder, name));
    found.into_iter().flatten().map(|(path, _)| path).collect()
}

/// The file of this name, and whether it is a binary one.
fn file(folder: &Path, name: &str) -> Result<(PathBuf, bool)> {
    let [binary, text] = ["bin", "txt"].map(|end| folder.join(name).with_extension(end));
    match (binary.is_file(), text.is_file()) {
        (true, _) => Ok((binary, true)),
        (false, true) => Ok((text, false)),
        (false, false) => {
            let what = format!("there is no {name}.bin and no {name}.txt in this folder");
            let help = "name the folder of a reconstruction by COLMAP, like \"sparse/0\"";
            Err(Error::invalid(folder, "", what, help))
        }
    }
}

fn broken(file: &Path, what: impl Into<String>) -> Error {
    Error::invalid(file, "", what, "export it again: colmap model_converter")
}

/// The error if there is no such image: lists some of the existing ones.
fn no_image(file: &Path, image: &str, names: &[String]) -> Error {
    let what = format!("there is no image {image:?}");
    let some: Vec<String> = names.iter().map(|name| format!("{name:?}")).collect();
    let help = match some.is_empty() {
        true => "it holds none".into(),
        false => format!("name one of them, like {}", some.join(", ")),
    };
    Error::invalid(file, "", what, help)
}

/// The names for that message.
fn note(names: &mut Vec<String>, name: &str) {
    if names.len() < 3 {
        names.push(name.into());
    }
}

/// The next line, of which at most [`LONGEST`] bytes are kept; `None` at the end.
fn line(reader: &mut impl BufRead, file: &Path) -> Result<Option<String>> {
    let mut kept = Vec::new();
    let mut is_any = false;
    loop {
        let buffer = reader.fill_buf().map_err(Error::io(file, "cannot read"))?;
        let end = buffer.iter().position(|byte| *byte == b'\n');
        let part = end.unwrap_or(buffer.len());
        is_any |= !buffer.is_empty();
        // A line of points may be megabytes long and is not needed: it is skipped, not kept.
        let room = LONGEST - kept.len();
        kept.extend_from_slice(&buffer[..part.min(room)]);
        // The end of line is used up with its line, and is not of it.
        let used = end.map_or(part, |end| end + 1);
        reader.consume(used);
        if end.is_some() || used == 0 {
            let text = String::from_utf8_lossy(&kept).trim().to_string();
            return Ok(is_any.then_some(text));
        }
    }
}

fn is_comment(line: &str) -> bool {
    line.starts_with('#')
}

/// `IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME`, and a line of points that are seen in it, which may be empty.
fn text_image(file: &Path, image: &str) -> Result<Image> {
    let mut reader = BufReader::new(open_regular(file)?.0);
    let mut names = Vec::new();
    while let Some(text) = line(&mut reader, file)? {
        if text.is_empty() || is_comment(&text) {
            continue;
        }
        // The name is the rest of the line, as it may hold spaces.
        let mut rest = text.as_str();
        let mut words = Vec::new();
        for _ in 0..9 {
            let (word, after) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
            words.push(word);
            rest = after.trim_start();
        }
        let numbers: Vec<f64> = words[1..8].iter().filter_map(|n| n.parse().ok()).collect();
        let ([w, x, y, z, a, b, c], Ok(camera)) = (numbers.as_slice(), words[8].parse()) else {
            return Err(broken(file, "this is not a line of an image"));
        };
        if rest == image {
            return Ok(Image {
                rotation: DQuat::from_xyzw(*x, *y, *z, *w),
                translation: DVec3::new(*a, *b, *c),
                camera,
            });
        }
        // The line of points exists even if it is empty.
        note(&mut names, rest);
        line(&mut reader, file)?;
    }
    Err(no_image(file, image, &names))
}

/// `CAMERA_ID MODEL WIDTH HEIGHT PARAMS…`.
fn text_camera(file: &Path, camera: u32) -> Result<ColmapPicture> {
    let mut reader = BufReader::new(open_regular(file)?.0);
    while let Some(text) = line(&mut reader, file)? {
        let words: Vec<&str> = text.split_whitespace().collect();
        let [id, model, numbers @ ..] = words.as_slice() else {
            continue;
        };
        if is_comment(&text) || id.parse() != Ok(camera) {
            continue;
        }
        // Only the requested camera must have a known model.
        let known = MODELS.iter().find(|known| known.0 == *model);
        let numbers: Option<Vec<f64>> = numbers.iter().map(|n| n.parse().ok()).collect();
        return match (known, numbers.as_deref()) {
            (None, _) => Err(unknown(file, model)),
            (Some(known), Some([width, height, of_model @ ..])) => {
                picture(file, known, [*width, *height], of_model)
            }
            _ => Err(broken(file, "this is not a line of a camera")),
        };
    }
    Err(broken(file, format!("there is no camera {camera}")))
}

fn unknown(file: &Path, model: &str) -> Error {
    let what = format!("the camera model {model} is unknown");
    Error::unsupported(file, "", what, UNDISTORT)
}

const UNDISTORT: &str =
    "a capture camera is a pinhole: remove the distortion with `colmap image_undistorter`";

/// The pictures of a camera without distortion.
fn picture(
    file: &Path,
    (name, count, focal): &(&str, usize, usize),
    [width, height]: [f64; 2],
    numbers: &[f64],
) -> Result<ColmapPicture> {
    let is_finite = numbers.iter().all(|n| n.is_finite());
    if numbers.len() != *count || !is_finite || !(width >= 1.0 && height >= 1.0) {
        return Err(broken(
            file,
            format!("this is not a camera of the model {name}"),
        ));
    }
    // Every model has its focal lengths, two numbers of the centre, and then distortion.
    let (lengths, rest) = numbers.split_at(*focal);
    let (centre, distortion) = rest.split_at(2);
    let refuse = |what: String, help: &str| Err(Error::unsupported(file, "", what, help));
    // Fisheyes bend lines even with all coefficients 0; the others are then pinholes.
    let is_fisheye = name.ends_with("FISHEYE") || *name == "FOV";
    if is_fisheye || distortion.iter().any(|n| *n != 0.0) {
        return refuse(format!("a camera of the model {name} distorts"), UNDISTORT);
    }
    // Captures have square pixels, so both focal lengths must agree, to a thousandth.
    let f = lengths[0];
    if lengths.iter().any(|f| *f <= 0.0) {
        return Err(broken(
            file,
            format!("focal lengths of {lengths:?} pixels are not above 0"),
        ));
    }
    if lengths.iter().any(|other| (other / f - 1.0).abs() > 1e-3) {
        return refuse(
            format!("focal lengths of {lengths:?} pixels mean that pixels are not square"),
            UNDISTORT,
        );
    }
    let centre = [centre[0], centre[1]];
    // The film of a capture has the principal point in its middle; a wide one is of no use.
    let most = 10.0 * width.max(height);
    if centre.iter().any(|place| place.abs() > most) {
        let what = format!("its principal point {centre:?} is far from its picture");
        return Err(broken(file, what));
    }
    Ok(ColmapPicture {
        size: [width, height],
        centre,
        focal: f,
    })
}

/// Numbers of a binary file, little-endian.
struct Binary<'a, R> {
    reader: R,
    file: &'a Path,
}

impl<R: BufRead> Binary<'_, R> {
    fn bytes<const N: usize>(&mut self) -> Result<[u8; N]> {
        let mut bytes = [0; N];
        match self.reader.read_exact(&mut bytes) {
            Ok(()) => Ok(bytes),
            Err(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => {
                Err(broken(self.file, "the file ends too early"))
            }
            Err(error) => Err(Error::io(self.file, "cannot read")(error)),
        }
    }

    fn u32(&mut self) -> Result<u32> {
        Ok(u32::from_le_bytes(self.bytes()?))
    }

    fn u64(&mut self) -> Result<u64> {
        Ok(u64::from_le_bytes(self.bytes()?))
    }

    fn f64(&mut self) -> Result<f64> {
        Ok(f64::from_le_bytes(self.bytes()?))
    }

    /// Up to a zero.
    fn name(&mut self) -> Result<String> {
        let mut name = Vec::new();
        loop {
            match self.bytes::<1>()? {
                [0] => return Ok(String::from_utf8_lossy(&name).into_owned()),
                _ if name.len() == LONGEST => return Err(broken(self.file, "a name has no end")),
                [byte] => name.push(byte),
            }
        }
    }

    fn skip(&mut self, count: u64) -> Result<()> {
        let skipped = std::io::copy(&mut (&mut self.reader).take(count), &mut std::io::sink());
        match skipped.map_err(Error::io(self.file, "cannot read"))? == count {
            true => Ok(()),
            false => Err(broken(self.file, "the file ends too early")),
        }
    }
}

fn binary(file: &Path) -> Result<Binary<'_, impl BufRead>> {
    let reader = BufReader::new(open_regular(file)?.0);
    Ok(Binary { reader, file })
}

fn binary_image(file: &Path, image: &str) -> Result<Image> {
    /// Bytes of an image point: its position and its number.
    const POINT: u64 = 24;
    let mut from = binary(file)?;
    let mut names = Vec::new();
    for _ in 0..from.u64()? {
        // The number of the image, which is not needed here.
        from.u32()?;
        let mut numbers = [0.0; 7];
        for number in &mut numbers {
            *number = from.f64()?;
        }
        let [w, x, y, z, a, b, c] = numbers;
        let camera = from.u32()?;
        let name = from.name()?;
        if name == image {
            return Ok(Image {
                rotation: DQuat::from_xyzw(x, y, z, w),
                translation: DVec3::new(a, b, c),
                camera,
            });
        }
        note(&mut names, &name);
        let points = from.u64()?;
        from.skip(points.saturating_mul(POINT))?;
    }
    Err(no_image(file, image, &names))
}

fn binary_camera(file: &Path, camera: u32) -> Result<ColmapPicture> {
    let mut from = binary(file)?;
    for _ in 0..from.u64()? {
        let (id, model) = (from.u32()?, from.u32()?);
        let Some(known) = MODELS.get(model as usize) else {
            return Err(unknown(file, &model.to_string()));
        };
        let size = [from.u64()? as f64, from.u64()? as f64];
        let mut numbers = [0.0; MOST];
        for number in &mut numbers[..known.1] {
            *number = from.f64()?;
        }
        if id == camera {
            return picture(file, known, size, &numbers[..known.1]);
        }
    }
    Err(broken(file, format!("there is no camera {camera}")))
}
