//! What was typed after `compare`.

use std::path::PathBuf;

use clap::Args;
use nullray::spacetime::units::Time;
use nullray::validate::compare::{Encoding, NotFinite, Tolerance};

#[derive(Debug, Args)]
pub struct CompareArguments {
    /// The picture that is right: .exr, .png, .npz or .npy.
    #[arg(value_name = "REFERENCE")]
    pub reference: PathBuf,
    /// The picture to check against it.
    #[arg(value_name = "CANDIDATE")]
    pub candidate: PathBuf,
    /// Channels and groups of them that are compared: "radiance,event". Default: all.
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub channels: Vec<String>,
    /// A picture of the same size, bright where pixels are compared.
    #[arg(long, value_name = "FILE")]
    pub mask: Option<PathBuf>,
    /// Left column, top row, width and height of the part that is compared.
    #[arg(long, value_name = "X,Y,W,H", value_parser = crop)]
    pub crop: Option<[u32; 4]>,
    /// What the codes of a .png are: "srgb" or "linear". Default: srgb.
    #[arg(long, value_name = "NAME", value_parser = transfer)]
    pub transfer: Option<Transfer>,
    /// What is done with light that is NaN or infinite: "refuse", "ignore", "count-as=VALUE". Default: refuse.
    #[arg(long, value_name = "POLICY", value_parser = nan)]
    pub nan: Option<Policy>,
    /// Width of a time bin, with its unit: "5 mm" or "16 ps". Emission times are given in bins too.
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub bin_width: Option<Time>,
    /// Pixels per degree of visual angle for FLIP. Default: 67.02, a 3840-pixel display of 0.7 m at 0.7 m.
    #[arg(long, value_name = "N", conflicts_with = "no_flip", value_parser = ppd)]
    pub ppd: Option<f64>,
    /// Leave FLIP out, which takes most of the time.
    #[arg(long)]
    pub no_flip: bool,
    /// Compare even where the metadata say that the reference is the approximation.
    #[arg(long)]
    pub allow_swapped: bool,
    /// A limit: exit code 1 where it is exceeded. Repeatable.
    #[arg(long, value_name = "METRIC=VALUE")]
    pub tolerance: Vec<Tolerance>,
    /// As JSON.
    #[arg(long)]
    pub json: bool,
    /// Write differences, FLIP and geometric errors as channels.
    #[arg(long, value_name = "FILE.exr")]
    pub maps: Option<PathBuf>,
    /// Write the errors in false colours with a legend.
    #[arg(long, value_name = "FILE.png")]
    pub error_map: Option<PathBuf>,
    /// Write the expected picture, the errors and the actual one side by side.
    #[arg(long, value_name = "FILE.png")]
    pub strip: Option<PathBuf>,
    /// Write everything on one page that needs nothing else.
    #[arg(long, value_name = "FILE.html")]
    pub report: Option<PathBuf>,
}

/// Parsed `--transfer`.
#[derive(Debug, Clone, Copy)]
pub struct Transfer(pub Encoding);

/// Parsed `--nan`.
#[derive(Debug, Clone, Copy)]
pub struct Policy(pub NotFinite);

fn transfer(text: &str) -> Result<Transfer, String> {
    match text {
        "srgb" => Ok(Transfer(Encoding::Srgb)),
        "linear" => Ok(Transfer(Encoding::Linear)),
        _ => Err("write srgb or linear".into()),
    }
}

fn nan(text: &str) -> Result<Policy, String> {
    let help = "write refuse, ignore, or count-as=VALUE";
    let policy = match text.split_once('=') {
        None if text == "refuse" => NotFinite::Refuse,
        None if text == "ignore" => NotFinite::Ignore,
        Some(("count-as", value)) => {
            let value = value.trim().parse::<f64>().ok().filter(|v| v.is_finite());
            NotFinite::CountAs(value.ok_or(help)?)
        }
        _ => return Err(help.into()),
    };
    Ok(Policy(policy))
}

fn crop(text: &str) -> Result<[u32; 4], String> {
    let numbers: Option<Vec<u32>> = text.split(',').map(|n| n.trim().parse().ok()).collect();
    let numbers = numbers.and_then(|n| <[u32; 4]>::try_from(n).ok());
    numbers.ok_or_else(|| "write X,Y,WIDTH,HEIGHT in pixels, for instance 100,50,64,64".into())
}

fn ppd(text: &str) -> Result<f64, String> {
    let number = text.trim().parse::<f64>().ok();
    let number = number.filter(|n| (1.0..=1000.0).contains(n));
    number.ok_or_else(|| "a number from 1 to 1000".into())
}
