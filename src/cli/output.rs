//! The files of one rendering, by extension, and the fingerprints that identify the files of a frame.
//!
//! fingerprint = SHA-256 (common, kind[, isochrone step]), with common = SHA-256 (version, scene text with the frame's time, poses and
//! spectra read from other files, channels, sampling, method, caption, content of every input file[, number of passes]); each part is
//! preceded by its length. That of unfinished sums is SHA-256 (samples, kind of work), with samples = SHA-256 (version, scene without names
//! and display, channels, sampling, content of every input file).

use std::fmt;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use nullray::Result;
use nullray::approximate::raster::Method;
use nullray::camera::Camera;
use nullray::figures::contact_sheet::{self, Layout, Panel, SheetOptions};
use nullray::figures::drawing::{Drawing, pdf, png, svg, tikz};
use nullray::figures::isochrones;
use nullray::figures::overlay::{self, Parts};
use nullray::io::files;
use nullray::io::image::{self, Layers, RgbImage};
use nullray::io::sealed::hexadecimal;
use nullray::render::aov::Aov;
use nullray::render::film::Film;
use nullray::render::metadata::metadata;
use nullray::render::plan::{self, Request};
use nullray::render::tonemap;
use nullray::scene::model::{Exposure, Mapping, Scene, Show, SourceKind};
use sha2::{Digest, Sha256};

use super::console::say;
use super::{caption, interrupt};

/// The channels needed to compute isochrones of `scene`.
pub fn times_need(scene: &Scene) -> Vec<Aov> {
    match scene.flash_times {
        Some(_) => isochrones::FLASH_NEEDS.to_vec(),
        None => vec![Aov::EventCt],
    }
}

/// The files of one rendering.
#[derive(Debug, Clone, Default)]
pub struct Outputs {
    /// By extension: png, exr, npz.
    pub images: Vec<PathBuf>,
    /// What a png shows.
    pub show: Show,
    /// The picture of retarded times, a png.
    pub isochrones: Option<PathBuf>,
    /// The picture of luminance with a legend, a png.
    pub luminance: Option<PathBuf>,
    /// Pictures with lines drawn over them, by extension: png, svg, pdf.
    pub overlays: Vec<PathBuf>,
    /// What is drawn over them.
    pub parts: Parts,
    /// Distance between isochrones, metres.
    pub step: Option<f64>,
    /// The requested auxiliary channels.
    pub aovs: Vec<Aov>,
    /// Radiance in .exr files in half precision.
    pub half: bool,
    /// The rendering method.
    pub method: Method,
    /// Text below pictures, with time and speed of the camera.
    pub caption: Option<String>,
    /// Distinguishes the files of a sequence's frame from all others.
    pub identity: Option<Identity>,
}

/// The content of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// The tone-mapped picture.
    Display,
    /// The picture of retarded times.
    Isochrones,
    /// The picture of luminance.
    Luminance,
    /// All channels, single precision.
    Exr,
    /// All channels, double precision.
    Npz,
}

impl Kind {
    /// The kind of a file with this name, which has been checked to be writable.
    fn of(path: &Path, show: Show) -> Kind {
        match (extension(path).as_str(), show) {
            ("exr", _) => Kind::Exr,
            ("npz", _) => Kind::Npz,
            (_, Show::Picture) => Kind::Display,
            (_, Show::Isochrones) => Kind::Isochrones,
            (_, Show::Luminance) => Kind::Luminance,
        }
    }

    /// A word for it.
    pub fn word(self) -> &'static str {
        match self {
            Kind::Display => "display",
            Kind::Isochrones => "isochrones",
            Kind::Luminance => "luminance",
            Kind::Exr => "exr",
            Kind::Npz => "npz",
        }
    }
}

impl Outputs {
    /// Auxiliary channels of `scene` that must be rendered.
    pub fn needs(&self, scene: &Scene) -> Vec<Aov> {
        let mut needed = self.aovs.clone();
        // Isochrones come from a separate picture, but the tracer plans for this one too.
        if self.files().any(|(_, kind)| kind == Kind::Isochrones) {
            needed.extend(times_need(scene));
            // Each once, in the order of the request, in which files list them.
            let mut seen = Vec::new();
            needed.retain(|aov| {
                !seen.contains(aov) && {
                    seen.push(*aov);
                    true
                }
            });
        }
        needed
    }

    /// The memory, in bytes, held beside a picture of `size`: films and pages of lines.
    pub fn beside(&self, size: [u32; 2]) -> u64 {
        let lines = match self.overlays.is_empty() {
            true => 0,
            false => overlay::bytes(size, self.parts),
        };
        // The times at the centres of pixels: radiance and one channel, f64, both as a film and as the channels of a picture.
        let centred = match self.files().any(|(_, kind)| kind == Kind::Isochrones) {
            true => 64 * u64::from(size[0]) * u64::from(size[1]),
            false => 0,
        };
        lines.saturating_add(centred)
    }

    /// All files of the film itself and their contents; not those with lines drawn over them.
    pub fn files(&self) -> impl Iterator<Item = (&Path, Kind)> {
        let images = self.images.iter();
        let images = images.map(|path| (path.as_path(), Kind::of(path, self.show)));
        let isochrones = self.isochrones.iter();
        let luminance = self.luminance.iter();
        images
            .chain(isochrones.map(|path| (path.as_path(), Kind::Isochrones)))
            .chain(luminance.map(|path| (path.as_path(), Kind::Luminance)))
    }

    /// All files, with the option that names them.
    pub fn paths(&self) -> impl Iterator<Item = (&'static str, &Path)> {
        let images = self.images.iter().map(|path| ("-o", path.as_path()));
        let isochrones = self.isochrones.iter();
        let overlays = self.overlays.iter();
        let luminance = self.luminance.iter();
        images
            .chain(isochrones.map(|path| ("--isochrones", path.as_path())))
            .chain(luminance.map(|path| ("--luminance", path.as_path())))
            .chain(overlays.map(|path| ("--overlay", path.as_path())))
    }

    /// Outputs of radiance alone: no lines, and no retarded times.
    pub fn of_film_alone(&self) -> Outputs {
        let is_picture = |path: &&PathBuf| Kind::of(path, self.show) != Kind::Isochrones;
        Outputs {
            images: self.images.iter().filter(is_picture).cloned().collect(),
            isochrones: None,
            overlays: Vec::new(),
            ..self.clone()
        }
    }

    /// The same, with every file renamed.
    pub fn renamed(&self, name: impl Fn(&Path) -> PathBuf) -> Outputs {
        Outputs {
            images: self.images.iter().map(|path| name(path)).collect(),
            isochrones: self.isochrones.as_deref().map(&name),
            luminance: self.luminance.as_deref().map(&name),
            overlays: self.overlays.iter().map(|path| name(path)).collect(),
            ..self.clone()
        }
    }

    /// Writes all files, one after the other; prints which unless `quiet`.
    ///
    /// `times` is the film of retarded times at pixel centres, if requested.
    pub fn write(
        &self,
        scene: &Scene,
        film: &Film,
        times: Option<&Film>,
        quiet: bool,
    ) -> Result<()> {
        self.write_each(scene, film, times, |line| {
            say(quiet, &line)?;
            interrupt::check()
        })
    }

    /// Like `write`, but passes the lines to print for each file to `written`.
    pub fn write_each(
        &self,
        scene: &Scene,
        film: &Film,
        times: Option<&Film>,
        mut written: impl FnMut(String) -> Result<()>,
    ) -> Result<()> {
        for (path, kind) in self.files() {
            let film = match kind {
                Kind::Isochrones => times.unwrap_or(film),
                Kind::Display | Kind::Luminance | Kind::Exr | Kind::Npz => film,
            };
            let note = self.write_one(path, kind, scene, film)?;
            written(format!("wrote {}{note}\n", path.display()))?;
        }
        Ok(())
    }

    /// What half precision, or else single precision, cannot hold of the radiance, if it is written to a file: values above the largest
    /// number, or, for half precision, values so small that they round to 0. A few dim pixels are not reported.
    pub fn beyond_precision(&self, film: &Film) -> Option<String> {
        if !self.files().any(|(_, kind)| kind == Kind::Exr) {
            return None;
        }
        if !self.half {
            return beyond_single(film);
        }
        const GREATEST: f64 = half::f16::MAX.to_f64_const();
        // Values up to half of the smallest number above 0, 2⁻²⁴, round to 0.
        const LEAST: f64 = 1.0 / (1u64 << 25) as f64;
        let of = |is_beyond: fn(f64) -> bool| {
            let pixels = film.radiance().iter();
            pixels
                .filter(|rgb| rgb.iter().any(|c| is_beyond(*c)))
                .count() as u64
        };
        let bright = of(|c| c.is_finite() && c.abs() > GREATEST);
        let dim = of(|c| c > 0.0 && c <= LEAST);
        let many = film.radiance().len() as u64 / 1000;
        let mut parts = Vec::new();
        if bright > 0 {
            let pixels = pixel_count(bright);
            parts.push(format!("{pixels} brighter than {GREATEST} were clamped"));
        }
        if dim > many {
            parts.push(format!(
                "{} with values up to 3e-8 were set to 0",
                pixel_count(dim)
            ));
        }
        (!parts.is_empty()).then(|| {
            let what = parts.join(", ");
            format!("--half: {what}: without --half the file holds them in f32")
        })
    }

    fn write_one(&self, path: &Path, kind: Kind, scene: &Scene, film: &Film) -> Result<String> {
        let mut metadata = metadata(scene, film)?;
        metadata.push(("method".into(), self.method.to_string()));
        if let Some(identity) = &self.identity {
            metadata.push((Identity::KEY.into(), identity.fingerprint(kind)));
        }
        match kind {
            Kind::Display => self.write_picture(path, Show::Picture, scene, film, metadata),
            Kind::Isochrones => self.write_picture(path, Show::Isochrones, scene, film, metadata),
            Kind::Luminance => self.write_picture(path, Show::Luminance, scene, film, metadata),
            Kind::Exr => self.write_exr(path, scene, film, metadata),
            Kind::Npz => self.write_npz(path, film, metadata),
        }
    }

    /// Writes a .png of 8 or 16 bits, and returns the radiance shown as white in it.
    fn write_picture(
        &self,
        path: &Path,
        show: Show,
        scene: &Scene,
        film: &Film,
        mut metadata: Vec<(String, String)>,
    ) -> Result<String> {
        let label = match (&self.caption, show) {
            (Some(words), Show::Picture) => Some(caption::of(words, scene)?),
            _ => None,
        };
        if show == Show::Picture && scene.bits == 16 {
            let (rgb, white, black) = tonemap::tonemap_16(film.radiance(), scene.exposure)?;
            let ends = Ends { white, black };
            metadata.extend(ends.metadata());
            let deep = Deep {
                size: film.size(),
                rgb,
            };
            let Deep { size: [w, h], rgb } = match label {
                Some(label) => deep.with_caption(label)?,
                None => deep,
            };
            image::png::write_16(path, w, h, &rgb, &metadata)?;
            return Ok(format!(" ({ends})"));
        }
        let Picture { mut image, ends } = picture(scene, film, show, self.step)?;
        metadata.extend(ends.iter().flat_map(Ends::metadata));
        if let Some(label) = label {
            image = contact_sheet::compose(&[panel(image, label)], &SheetOptions::default())?;
        }
        image::png::write(path, image.width, image.height, &image.rgb, &metadata)?;
        Ok(match (show, ends) {
            (_, Some(ends)) => format!(" ({ends})"),
            (Show::Luminance, _) => " (luminance)".into(),
            _ if scene.flash_times.is_some() => " (times of the flash)".into(),
            _ => " (retarded time)".into(),
        })
    }

    fn write_exr(
        &self,
        path: &Path,
        scene: &Scene,
        film: &Film,
        metadata: Vec<(String, String)>,
    ) -> Result<String> {
        let layers = self.layers(film, metadata)?;
        let camera = Camera::new(scene)?;
        let options = image::exr::Options {
            half: self.half,
            sealed: self.is_sealed(),
            matrices: camera.matrices(),
            window_width: camera.window_width(),
        };
        image::exr::write_with(path, &layers, &options)?;
        Ok(channel_count(&layers))
    }

    fn write_npz(
        &self,
        path: &Path,
        film: &Film,
        metadata: Vec<(String, String)>,
    ) -> Result<String> {
        let layers = self.layers(film, metadata)?;
        match self.is_sealed() {
            true => image::npz::write_sealed(path, &layers)?,
            false => image::npz::write(path, &layers)?,
        }
        Ok(channel_count(&layers))
    }

    fn layers(&self, film: &Film, metadata: Vec<(String, String)>) -> Result<Layers> {
        let [width, height] = film.size();
        Layers::new(width, height, film.channels(&self.aovs), metadata)
    }

    /// Whether files carry a checksum; those of single pictures are never checked later.
    fn is_sealed(&self) -> bool {
        self.identity.is_some()
    }
}

fn channel_count(layers: &Layers) -> String {
    format!(" ({} channels)", layers.channels.len())
}

/// The values of the radiance that single precision cannot hold.
fn beyond_single(film: &Film) -> Option<String> {
    let is_beyond = |c: &f64| c.is_finite() && c.abs() > f64::from(f32::MAX);
    let pixels = film.radiance().iter();
    let bright = pixels.filter(|rgb| rgb.iter().any(is_beyond)).count() as u64;
    (bright > 0).then(|| {
        let pixels = pixel_count(bright);
        format!(
            "EXR: {pixels} brighter than {:.4e} were clamped: a .npz file holds them in f64",
            f32::MAX
        )
    })
}

/// A number of pixels, in words.
fn pixel_count(count: u64) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{} pixel{plural}", plan::count(count))
}

/// A number to five significant digits, in a form that `--white` accepts.
pub fn five_digits(value: f64) -> String {
    let exponent = value.abs().log10().floor();
    if !(-4.0..7.0).contains(&exponent) {
        return format!("{value:.4e}");
    }
    let decimals = (4.0 - exponent).max(0.0) as usize;
    format!("{value:.decimals$}")
}

pub fn extension(path: &Path) -> String {
    path.extension()
        .map_or(String::new(), |e| e.to_string_lossy().to_ascii_lowercase())
}

/// The radiances at the ends of a display's scale.
#[derive(Debug, Clone, Copy)]
pub struct Ends {
    white: f64,
    /// `None` for a linear scale.
    black: Option<f64>,
}

impl Ends {
    /// Their metadata in a file. "white" alone means a linear scale.
    fn metadata(&self) -> Vec<(String, String)> {
        match self.black {
            None => vec![("white".into(), self.white.to_string())],
            Some(black) => vec![("logarithmic".into(), format!("{black} {}", self.white))],
        }
    }

    /// Those of `exposure`, if it has any before a picture is measured.
    pub fn of(exposure: Exposure) -> Option<Self> {
        let (white, black) = match exposure {
            Exposure::White(white) => (white, None),
            Exposure::Logarithmic([black, white]) => (white, Some(black)),
            _ => return None,
        };
        Some(Ends { white, black })
    }
}

impl fmt::Display for Ends {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let white = five_digits(self.white);
        match self.black {
            None => write!(f, "white is radiance {white}"),
            Some(black) => write!(
                f,
                "by the logarithm of radiance, from {} to {white}",
                five_digits(black)
            ),
        }
    }
}

fn panel(picture: RgbImage, label: String) -> Panel {
    Panel {
        picture,
        label,
        new_row: false,
    }
}

/// A picture of 16 bits per sample.
struct Deep {
    size: [u32; 2],
    rgb: Vec<u16>,
}

impl Deep {
    /// The picture on a page with this caption. The page is made for a black picture, and this one is copied into it.
    fn with_caption(self, label: String) -> Result<Deep> {
        let [width, height] = self.size;
        let black = RgbImage {
            width,
            height,
            rgb: vec![0; self.rgb.len()],
        };
        let panels = [panel(black, label)];
        let layout = Layout::new(&panels, &SheetOptions::default())?;
        let page = contact_sheet::compose(&panels, &SheetOptions::default())?;
        // 255 · 257 = 65535: converts 8-bit codes to 16 bits.
        let mut rgb: Vec<u16> = page.rgb.iter().map(|code| u16::from(*code) * 257).collect();
        if let Some(cell) = layout.cells.first() {
            let scale = layout.scale as usize;
            let (left, top) = (cell.picture.left as usize, cell.picture.top as usize);
            let rows = rgb.chunks_exact_mut(3 * page.width as usize).skip(top);
            let lines = self.rgb.chunks_exact(3 * width as usize);
            for (row, line) in rows.zip(lines.flat_map(|line| std::iter::repeat_n(line, scale))) {
                let spread = line
                    .chunks_exact(3)
                    .flat_map(|rgb| std::iter::repeat_n(rgb, scale));
                for (place, rgb) in row.chunks_exact_mut(3).skip(left).zip(spread) {
                    place.copy_from_slice(rgb);
                }
            }
        }
        Ok(Deep {
            size: [page.width, page.height],
            rgb,
        })
    }
}

/// A picture, and the ends of its scale if it shows radiance.
pub struct Picture {
    pub image: RgbImage,
    pub ends: Option<Ends>,
}

/// The picture of what `show` selects from `film`; isochrones are `step` metres apart, or at round numbers.
pub fn picture(scene: &Scene, film: &Film, show: Show, step: Option<f64>) -> Result<Picture> {
    match show {
        Show::Picture => display(scene, film),
        Show::Isochrones => Ok(Picture {
            image: times(scene, film, step)?,
            ends: None,
        }),
        Show::Luminance => {
            let [width, height] = film.size();
            let (pixels, range) = (film.radiance(), scene.luminances);
            Ok(Picture {
                image: isochrones::draw_radiance(width, height, pixels, "Luminance", range)?,
                ends: None,
            })
        }
    }
}

fn display(scene: &Scene, film: &Film) -> Result<Picture> {
    let [width, height] = film.size();
    let mapped = tonemap::tonemap(film.radiance(), scene.exposure)?;
    Ok(Picture {
        image: RgbImage {
            width,
            height,
            rgb: mapped.rgb,
        },
        ends: Some(Ends {
            white: mapped.white,
            black: mapped.black,
        }),
    })
}

fn times(scene: &Scene, film: &Film, step: Option<f64>) -> Result<RgbImage> {
    let [width, height] = film.size();
    let mut options = isochrones::IsochroneOptions {
        step,
        range: scene.times,
        speed_of_light: scene.speed_of_light,
        ..isochrones::IsochroneOptions::default()
    };
    let of_flash = scene.flash_times.map(|times| {
        options.title = isochrones::flash_title(times.clock).into();
        isochrones::flash_times(film, &times, scene.medium_index)
    });
    let times = of_flash
        .as_deref()
        .or(film.aov(Aov::EventCt))
        .unwrap_or_default();
    isochrones::draw(width, height, times, &options)
}

/// A drawing in the format with this extension; for .png with the given pixels per point.
pub fn encoded(drawing: &Drawing, kind: &str, scale: f64) -> Result<Vec<u8>> {
    match kind {
        "svg" => Ok(svg::write(drawing)?.into_bytes()),
        "pdf" => pdf::write(drawing),
        "tex" => Ok(tikz::write(drawing)?.into_bytes()),
        _ => png::write(&png::render(drawing, scale)?),
    }
}

/// The content of all input files.
pub struct Inputs {
    digest: Vec<u8>,
    /// The files as they were before they were read.
    pub stamp: Stamp,
}

impl Inputs {
    /// Reads the files. One that cannot be read counts as missing; whether it is needed is decided later.
    pub fn read(paths: &[PathBuf]) -> Inputs {
        let stamp = Stamp::of(paths);
        let mut all = Digests::default();
        for path in paths {
            match content(path) {
                Some(hash) => all.add(&hash),
                None => all.add(b"none"),
            }
        }
        Inputs {
            digest: all.finish(),
            stamp,
        }
    }
}

/// The state of files at one moment: their lengths, times and identities.
pub struct Stamp(Vec<(PathBuf, Option<Mark>)>);

/// Length and modification time, and on systems that have them, the numbers that identify the file and its last status change.
type Mark = (u64, Option<SystemTime>, [i64; 3]);

impl Stamp {
    /// The files of these names.
    pub fn of<'p>(paths: impl IntoIterator<Item = &'p PathBuf>) -> Stamp {
        let paths = paths.into_iter();
        Stamp(paths.map(|path| (path.clone(), mark(path))).collect())
    }

    /// A file that has changed.
    pub fn changed(&self) -> Option<&Path> {
        let changed = self.0.iter().find(|(path, then)| mark(path) != *then);
        changed.map(|(path, _)| path.as_path())
    }
}

fn mark(path: &Path) -> Option<Mark> {
    let metadata = std::fs::metadata(path).ok()?;
    // Copying can set the modification time back, but not the time of the last status change.
    #[cfg(unix)]
    let more = {
        use std::os::unix::fs::MetadataExt;
        [
            metadata.ino() as i64,
            metadata.ctime(),
            metadata.ctime_nsec(),
        ]
    };
    #[cfg(not(unix))]
    let more = [0; 3];
    Some((metadata.len(), metadata.modified().ok(), more))
}

fn content(path: &Path) -> Option<Vec<u8>> {
    let (mut reader, _) = files::open(path).ok()?;
    let mut hash = Sha256::new();
    let mut block = vec![0; 1 << 16];
    loop {
        match reader.read(&mut block).ok()? {
            0 => return Some(hash.finalize().to_vec()),
            n => hash.update(block.get(..n)?),
        }
    }
}

/// Distinguishes the files of a frame from all others.
#[derive(Debug, Clone)]
pub struct Identity {
    common: Vec<u8>,
    step: Option<f64>,
}

impl Identity {
    /// The key of the fingerprint in the metadata of files.
    pub const KEY: &'static str = "frame_fingerprint";

    /// The identity of the frame shown by `scene`; `passes` describes those of a progressive one.
    pub fn new(
        scene: &Scene,
        request: &Request,
        outputs: &Outputs,
        inputs: &Inputs,
        passes: &str,
    ) -> Identity {
        let mut parts = Digests::default();
        parts.add(env!("CARGO_PKG_VERSION").as_bytes());
        parts.add(scene.text.as_bytes());
        parts.add(looks(scene).as_bytes());
        for aov in &outputs.aovs {
            parts.add(aov.name().as_bytes());
        }
        parts.add(&[u8::from(request.pixel_centers)]);
        parts.add(&[u8::from(outputs.half)]);
        // The white may be measured over a whole sequence; then it is not in the scene's text.
        if let Exposure::White(white) = scene.exposure {
            parts.add(&white.to_le_bytes());
        }
        parts.add(outputs.method.to_string().as_bytes());
        parts.add(outputs.caption.as_deref().unwrap_or("\0").as_bytes());
        parts.add(request.precision.name().as_bytes());
        parts.add(&inputs.digest);
        parts.add(passes.as_bytes());
        Identity {
            common: parts.finish(),
            step: outputs.step,
        }
    }

    /// The fingerprint of the frame's file of this kind, as text.
    pub fn fingerprint(&self, kind: Kind) -> String {
        let step = self.step.filter(|_| kind == Kind::Isochrones);
        self.number(kind.word(), step)
    }

    /// The fingerprint of the frame's picture with these lines over it, as text.
    pub fn of_overlay(&self, parts: Parts) -> String {
        self.number(&format!("overlay {parts:?}"), self.step)
    }

    fn number(&self, what: &str, step: Option<f64>) -> String {
        let mut parts = Digests::default();
        parts.add(&self.common);
        parts.add(what.as_bytes());
        if let Some(step) = step {
            parts.add(&step.to_le_bytes());
        }
        hexadecimal(&parts.finish())
    }
}

/// All that the samples of a scene depend on, however they are shown later.
pub struct Samples(Vec<u8>);

impl Samples {
    /// Those of `scene`.
    pub fn new(scene: &Scene, request: &Request, inputs: &Inputs) -> Samples {
        let mut parts = Digests::default();
        parts.add(env!("CARGO_PKG_VERSION").as_bytes());
        parts.add(format!("{:?}", scene.unshown()).as_bytes());
        for aov in &request.aovs {
            parts.add(aov.name().as_bytes());
        }
        parts.add(&[u8::from(request.pixel_centers)]);
        parts.add(request.precision.name().as_bytes());
        parts.add(&inputs.digest);
        Samples(parts.finish())
    }

    /// The fingerprint of their sums in unfinished work with this description.
    pub fn of_sums(&self, what: &str) -> [u8; 32] {
        let mut parts = Digests::default();
        parts.add(&self.0);
        parts.add(what.as_bytes());
        parts.0.finalize().into()
    }
}

/// Cameras and spectra, which may come from files that are not listed as inputs.
fn looks(scene: &Scene) -> String {
    let captures = scene
        .sources
        .iter()
        .filter_map(|source| match &source.kind {
            SourceKind::Cube(cube) => match &cube.mapping {
                Mapping::Capture(camera) => Some(camera),
                Mapping::Uv { .. } => None,
            },
            SourceKind::Pulse(_) => None,
        });
    let captures = captures.collect::<Vec<_>>();
    let spectra = scene.objects.iter().map(|object| &object.spectrum);
    let spectra = spectra.collect::<Vec<_>>();
    format!("{:?} {captures:?} {spectra:?}", scene.camera)
}

/// Hashes parts so that different lists of parts give different input to the hash.
#[derive(Default)]
struct Digests(Sha256);

impl Digests {
    fn add(&mut self, part: &[u8]) {
        self.0.update((part.len() as u64).to_le_bytes());
        self.0.update(part);
    }

    fn finish(self) -> Vec<u8> {
        self.0.finalize().to_vec()
    }
}
