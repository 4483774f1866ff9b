//! A picture of a sequence, decoded: linear radiance, whatever its format.

use std::path::{Path, PathBuf};

use super::channels::Channels;
use super::wanted::{Transfer, Wanted};
use crate::colour::srgb_decode;
use crate::error::{Error, Result};
use crate::io::budget::Budget;
use crate::io::image::{self, Layers, Samples};

/// The longest picture file that is read as a whole, bytes.
const LONGEST: u64 = 1 << 30;

/// A picture of a sequence: one of the pictures in a file.
pub(super) struct Frame {
    pub file: PathBuf,
    /// The first in it is 0.
    #[cfg_attr(
        not(feature = "tiff"),
        expect(dead_code, reason = "only stacks of TIFF have more than one")
    )]
    pub number: usize,
}

/// The number of pictures of one size in a file; more than one in TIFF stacks.
///
/// # Errors
/// It cannot be read.
pub fn frame_count(file: &Path) -> Result<usize> {
    match extension(file).as_str() {
        #[cfg(feature = "tiff")]
        "tif" | "tiff" => image::tiff::count(file),
        _ => Ok(1),
    }
}

/// The end of its name, lower case; empty for none.
pub(super) fn extension(file: &Path) -> String {
    let extension = file.extension().and_then(|e| e.to_str()).unwrap_or("");
    extension.to_ascii_lowercase()
}

/// Its name without its folder.
pub(super) fn file_name(file: &Path) -> String {
    file.file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

/// The size of a picture, shared by all of a sequence.
pub(super) struct Form {
    /// Columns and rows.
    pub size: [usize; 2],
    /// 1 or 3, or the number of named channels.
    pub channels: usize,
    /// The memory for reading it, bytes.
    pub memory: u64,
}

impl Form {
    /// The size of a picture: from the header for PNG; others are read.
    pub fn of(frame: &Frame, wanted: Wanted) -> Result<Form> {
        if extension(&frame.file) == "png" {
            refuse_names(&frame.file, wanted)?;
            linear_of(&frame.file, wanted.transfer)?;
            let form = image::png::frame_form(&frame.file)?;
            return Ok(Form {
                size: form.size,
                channels: form.channels,
                memory: form.memory,
            });
        }
        let budget = wanted.budget();
        let picture = Picture::read(frame, wanted, &budget)?;
        Ok(Form {
            size: picture.size,
            channels: picture.channels,
            memory: budget.taken(),
        })
    }
}

/// A decoded picture, linear.
pub(super) struct Picture {
    /// Columns and rows.
    pub size: [usize; 2],
    /// 1 or 3, or the number of named channels.
    pub channels: usize,
    /// By rows, colours fastest; all finite.
    pub samples: Vec<f32>,
}

impl Picture {
    /// The picture, by the extension of its file, with memory of `budget`; every sample of it is finite.
    pub fn read(frame: &Frame, wanted: Wanted, budget: &Budget) -> Result<Picture> {
        let (file, transfer) = (&*frame.file, wanted.transfer);
        let extension = extension(file);
        refuse_names(file, wanted)?;
        let picture = match extension.as_str() {
            "exr" => {
                refuse_transfer(file, transfer)?;
                let layers = image::exr::read_whole(file, budget)?;
                match wanted.channels {
                    Some(channels) => Picture::of_names(file, &layers, channels, budget)?,
                    None => Picture::of_exr(file, &layers, budget)?,
                }
            }
            "hdr" => {
                refuse_transfer(file, transfer)?;
                let (size, pixels) = image::hdr::read(&bytes(file, budget)?, file, budget)?;
                Picture {
                    size,
                    channels: 3,
                    samples: pixels.into_flattened(),
                }
            }
            "png" => Picture::of_png(file, transfer, budget)?,
            "tif" | "tiff" => Picture::of_tiff(frame, transfer, budget)?,
            _ => {
                let what = "frames are .exr, .png, .hdr or .tif pictures";
                return Err(Error::unsupported(
                    file,
                    "",
                    what,
                    "convert the frames to EXR",
                ));
            }
        };
        // From the index in the list of samples to the position in the picture, for the message.
        let width = picture.size[0] * picture.channels;
        match picture
            .samples
            .iter()
            .position(|sample| !sample.is_finite())
        {
            Some(bad) => Err(Error::invalid(
                file,
                format!(
                    "row {}, column {}",
                    bad / width,
                    bad % width / picture.channels
                ),
                "the sample is not a finite number",
                "radiance must be finite",
            )),
            None => Ok(picture),
        }
    }

    /// The channels of these names, in their order.
    fn of_names(
        file: &Path,
        layers: &Layers,
        channels: &Channels,
        budget: &Budget,
    ) -> Result<Picture> {
        let mut planes = Vec::with_capacity(channels.count());
        for (name, stored) in channels.names().into_iter().zip(channels.in_pictures()) {
            let Some(channel) = layers.channel(stored) else {
                let what = format!(
                    "it has no channel {name}; its channels are {}",
                    names_in(layers)
                );
                let help = "name channels that the picture has";
                return Err(Error::invalid(file, "channels", what, help));
            };
            planes.push(&channel.samples);
        }
        Picture::of_planes(file, layers, &planes, budget)
    }

    /// Planes of one channel each, which become pixels.
    fn of_planes(
        file: &Path,
        layers: &Layers,
        planes: &[&Samples],
        budget: &Budget,
    ) -> Result<Picture> {
        let size = [layers.width as usize, layers.height as usize];
        let count = size[0] * size[1] * planes.len();
        budget.take(4 * count as u64, file)?;
        let mut samples = Vec::with_capacity(count);
        for at in 0..size[0] * size[1] {
            samples.extend(planes.iter().map(|plane| match plane {
                Samples::F32(v) => v[at],
                Samples::F64(v) => v[at] as f32,
                Samples::U32(v) => v[at] as f32,
                Samples::I32(v) => v[at] as f32,
            }));
        }
        Ok(Picture {
            size,
            channels: planes.len(),
            samples,
        })
    }

    /// R, G and B, or else the only channel other than alpha or depth.
    fn of_exr(file: &Path, layers: &Layers, budget: &Budget) -> Result<Picture> {
        let colours = ["radiance.R", "radiance.G", "radiance.B"];
        let colours = colours.map(|name| layers.channel(name).map(|channel| &channel.samples));
        if let [Some(r), Some(g), Some(b)] = colours {
            return Picture::of_planes(file, layers, &[r, g, b], budget);
        }
        match layers.grey() {
            Some(channel) => Picture::of_planes(file, layers, &[&channel.samples], budget),
            None => {
                let what = format!(
                    "its channels are {}, neither R, G, B nor a single one",
                    names_in(layers)
                );
                Err(Error::unsupported(
                    file,
                    "",
                    what,
                    "write frames with the channels R, G, B, or Y alone",
                ))
            }
        }
    }

    fn of_png(file: &Path, transfer: Option<Transfer>, budget: &Budget) -> Result<Picture> {
        let linear = linear_of(file, transfer)?;
        let form = image::png::frame_form(file)?;
        Ok(Picture {
            size: form.size,
            channels: form.channels,
            samples: image::png::read_frame(file, budget, linear)?,
        })
    }

    /// Integers are codes, as in PNG; floating-point samples are linear.
    #[cfg(feature = "tiff")]
    fn of_tiff(frame: &Frame, transfer: Option<Transfer>, budget: &Budget) -> Result<Picture> {
        let file = &*frame.file;
        let image::tiff::Tiff {
            size,
            channels,
            mut samples,
            is_coded,
        } = image::tiff::read(file, frame.number, budget)?;
        if is_coded {
            let linear = linear_of(file, transfer)?;
            for sample in &mut samples {
                *sample = linear((*sample).into());
            }
        } else {
            refuse_transfer(file, transfer)?;
        }
        Ok(Picture {
            size,
            channels,
            samples,
        })
    }

    #[cfg(not(feature = "tiff"))]
    fn of_tiff(frame: &Frame, _: Option<Transfer>, _: &Budget) -> Result<Picture> {
        let file = &*frame.file;
        let what = "this program was built without TIFF";
        let help = "install it with TIFF (in its sources: cargo install --path . --features tiff), or convert the frames to EXR";
        Err(Error::unsupported(file, "", what, help))
    }

    pub fn refuse_other_than(&self, first: &Form, file: &Path, first_file: &Path) -> Result<()> {
        if (self.size, self.channels) == (first.size, first.channels) {
            return Ok(());
        }
        let said = |[width, height]: [usize; 2], channels: usize| {
            let plural = if channels == 1 { "" } else { "s" };
            format!("{width} × {height} pixels of {channels} channel{plural}")
        };
        let what = format!(
            "it has {}, and {} has {}",
            said(self.size, self.channels),
            file_name(first_file),
            said(first.size, first.channels)
        );
        Err(Error::invalid(
            file,
            "",
            what,
            "all pictures of a sequence have one size and the same channels",
        ))
    }
}

/// The names of its channels in the file, where colours are R, G and B.
fn names_in(layers: &Layers) -> String {
    // A picture may have thousands of channels: ten are enough to show.
    let channels = layers.channels.iter().take(10);
    let names = channels.map(|channel| {
        let name = channel.name.as_str();
        name.strip_prefix("radiance.").unwrap_or(name)
    });
    names.collect::<Vec<_>>().join(", ")
}

/// Refuses channel names for a picture without them: only EXR stores channels by name.
fn refuse_names(file: &Path, wanted: Wanted) -> Result<()> {
    if wanted.channels.is_none() || extension(file) == "exr" {
        return Ok(());
    }
    let what = "the channels of this picture are grey or red, green and blue";
    let help = "leave `channels` out, or store named channels in an EXR picture";
    Err(Error::invalid(file, "channels", what, help))
}

/// From codes to radiance, by the caller's declaration.
fn linear_of(file: &Path, transfer: Option<Transfer>) -> Result<fn(f64) -> f32> {
    match transfer {
        Some(Transfer::Linear) => Ok(|code| code as f32),
        Some(Transfer::Srgb) => Ok(|code| srgb_decode(code) as f32),
        None => {
            let what = "the codes of this picture are not radiance as they stand";
            let help =
                "declare how the codes encode it: transfer = \"linear\" or \"srgb\" in the source";
            Err(Error::invalid(file, "", what, help))
        }
    }
}

fn refuse_transfer(file: &Path, transfer: Option<Transfer>) -> Result<()> {
    match transfer {
        Some(Transfer::Srgb) => Err(Error::invalid(
            file,
            "",
            "this picture is linear by its format",
            "leave out `transfer`",
        )),
        Some(Transfer::Linear) | None => Ok(()),
    }
}

/// A whole file, with memory of `budget`.
fn bytes(file: &Path, budget: &Budget) -> Result<Vec<u8>> {
    use std::io::Read;
    let (reader, length) = crate::io::open::open_regular(file)?;
    if length > LONGEST {
        return Err(Error::unsupported(
            file,
            "",
            "the picture is longer than 1 GiB",
            "convert the frames to EXR",
        ));
    }
    budget.take(length, file)?;
    let mut bytes = Vec::new();
    // The file may have grown since its length was read.
    reader
        .take(LONGEST)
        .read_to_end(&mut bytes)
        .map_err(Error::io(file, "cannot read"))?;
    Ok(bytes)
}
