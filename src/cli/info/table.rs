//! The contents of a table in a text file: a spectrum, or stars.

use std::io::Read;
use std::path::Path;

use nullray::io::{files, spectrum};
use nullray::light::sky::stars;
use nullray::render::plan::count;
use nullray::scene::model::{Catalogue, Stars};
use nullray::{Error, Result};

use super::Info;

/// The longest table of stars that is read, bytes.
const LONGEST: u64 = 1 << 28;

pub fn info(path: &Path) -> Result<Info> {
    let of_lamp = match spectrum::load(path) {
        Ok(rows) => return Ok(of_spectrum(path, &rows)),
        Err(error) => error,
    };
    let (file, _) = files::open(path).map_err(Error::io(path, "cannot read"))?;
    let mut bytes = Vec::new();
    let read = file.take(LONGEST).read_to_end(&mut bytes);
    read.map_err(Error::io(path, "cannot read"))?;
    let catalogue = Stars {
        catalogue: Catalogue::File(path.into()),
        scale: 1.0,
        radius: 0.0,
    };
    let text = String::from_utf8_lossy(&bytes);
    match (stars(&catalogue, &text), columns(&text)) {
        (Ok(all), _) => Ok(of_stars(path, all.len())),
        (Err(_), 2) => Err(of_lamp),
        (Err(of_stars), 5) => Err(of_stars),
        (Err(_), _) => Err(Error::unsupported(
            path,
            "",
            "this is neither the table of a spectrum nor one of stars",
            "lines of a spectrum hold a wavelength in nm and a value, those of stars x,y,z,magnitude,temperature",
        )),
    }
}

/// The number of columns of the first line that begins with two numbers; 0 without any.
fn columns(text: &str) -> usize {
    let entries = |line: &str| {
        let line = line.trim_start_matches('\u{feff}');
        let entries = line.split([',', ';', ' ', '\t']);
        let entries: Vec<&str> = entries.filter(|entry| !entry.is_empty()).collect();
        let is_row =
            matches!(entries[..], [a, b, ..] if [a, b].iter().all(|x| x.parse::<f64>().is_ok()));
        is_row.then_some(entries.len())
    };
    text.lines().find_map(entries).unwrap_or(0)
}

fn of_spectrum(path: &Path, rows: &[[f64; 2]]) -> Info {
    let mut info = Info::new("spectrum", "table of a spectrum");
    info.fact("rows", count(rows.len() as u64), "rows", rows.len());
    if let (Some([first, _]), Some([last, _])) = (rows.first(), rows.last()) {
        let nanometres = [first, last].map(|metres| (metres * 1e12).round() / 1e3);
        let [from, to] = nanometres;
        info.row("wavelengths", format!("{from} to {to} nm"));
        info.data("nanometres", nanometres.to_vec());
    }
    let usable = match rows.iter().all(|[_, value]| *value == 0.0) {
        true => "no: all values are 0".into(),
        false => format!("as spectrum = {{ table = {:?} }}", name(path)),
    };
    info.row("usable", usable);
    info
}

fn of_stars(path: &Path, stars: usize) -> Info {
    let mut info = Info::new("stars", "table of stars");
    info.fact("stars", count(stars as u64), "stars", stars);
    info.row(
        "usable",
        format!("as stars = {{ file = {:?} }} of a [sky]", name(path)),
    );
    info
}

fn name(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}
