//! What every part of resolution asks: times in metres, positive numbers, colours, paths.

use std::fmt::Display;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::io::files;
use crate::io::gltf::{self, GltfCamera};
use crate::scene::at::At;
use crate::scene::report::Report;
use crate::scene::values::{Number, Vector};
use crate::spacetime::units::{Acceleration, AngularRate, LARGEST, Length, Speed, Time, quoted};

/// The smallest positive number accepted: powers of smaller ones leave f64's range.
const SMALLEST: f64 = 1e-30;

/// Factors on a bound, for naming in a message four digits that are safely on the right side of it.
pub(super) const BELOW: f64 = 0.999;
pub(super) const ABOVE: f64 = 1.001;

/// Reads the pose of a camera from a glTF file: the named node's, or the only one.
pub(crate) type ReadGltfCamera = fn(&Path, Option<&str>) -> Result<GltfCamera>;

/// The surroundings of a scene that is being resolved.
pub(crate) struct Context<'a> {
    /// The text, for refusals.
    pub report: Report,
    /// The folder against which relative paths resolve.
    pub base: &'a Path,
    /// Metres per second, above 0.
    pub speed_of_light: f64,
    /// How the pose of a glTF camera is read.
    pub read_gltf_camera: ReadGltfCamera,
}

impl<'a> Context<'a> {
    pub fn new(report: Report, base: &'a Path, c: &At<Speed>) -> Result<Self> {
        let speed_of_light = c.value.metres_per_second();
        if speed_of_light <= 0.0 {
            let what = format!("the speed of light {} is not above 0", c.value);
            return Err(report.refuse(&c.span, what, "any positive speed will do"));
        }
        Ok(Context {
            report,
            base,
            speed_of_light,
            read_gltf_camera: gltf::camera,
        })
    }

    /// The refusal of what `at` says.
    pub fn refuse<T>(&self, at: &At<T>, what: impl Into<String>, help: impl Into<String>) -> Error {
        self.report.refuse(&at.span, what, help)
    }

    /// The refusal of `second`, which cannot be said together with `first`.
    pub fn refuse_both<T, U>(
        &self,
        (first, first_key): (&At<T>, &str),
        (second, second_key): (&At<U>, &str),
    ) -> Error {
        let what = format!("`{first_key}` and `{second_key}` exclude each other");
        let help = format!("keep one of `{first_key}` and `{second_key}`");
        let other = (&first.span, "and here");
        self.report.refuse_two(&second.span, other, what, help)
    }

    /// Refuses two keys that are both there.
    pub fn exclusive<T, U>(
        &self,
        (first, first_key): (&Option<At<T>>, &str),
        (second, second_key): (&Option<At<U>>, &str),
    ) -> Result<()> {
        match (first, second) {
            (Some(first), Some(second)) => {
                Err(self.refuse_both((first, first_key), (second, second_key)))
            }
            _ => Ok(()),
        }
    }

    /// A time in metres.
    pub fn time(&self, time: &At<Time>) -> Result<f64> {
        let metres = time.value.metres(self.speed_of_light);
        if metres.abs() <= LARGEST {
            return Ok(metres);
        }
        let what = format!(
            "{} is {metres:e} m of light path, beyond {LARGEST:e}",
            time.value
        );
        Err(self.refuse(time, what, "give a shorter time"))
    }

    /// A proper acceleration (a/c²) in 1/m.
    pub fn acceleration(&self, acceleration: &At<Acceleration>) -> Result<f64> {
        let value = acceleration.value.per_metre(self.speed_of_light);
        self.per_metre(acceleration, value, "/m")
    }

    /// An angular rate in radians per metre.
    pub fn angular_rate(&self, rate: &At<AngularRate>) -> Result<f64> {
        let value = rate.value.radians_per_metre(self.speed_of_light);
        self.per_metre(rate, value, "rad/m")
    }

    fn per_metre<T: Display>(&self, at: &At<T>, value: f64, unit: &str) -> Result<f64> {
        if value.abs() <= LARGEST {
            return Ok(value);
        }
        let what = format!("{} is {value:e} {unit}, beyond {LARGEST:e}", at.value);
        Err(self.refuse(at, what, "give a smaller one"))
    }

    /// A length above 0, in metres.
    pub fn positive_length(&self, length: &At<Length>, name: &str) -> Result<f64> {
        let like = format!("like \"{}\"", Length::customary(0.05));
        self.above_zero(length, length.value.metres(), name, &like)
    }

    /// A time above 0, in metres.
    pub fn duration(&self, time: &At<Time>, name: &str) -> Result<f64> {
        let metres = self.time(time)?;
        self.above_zero(
            time,
            metres,
            name,
            &format!("like \"{}\"", Time::customary(0.05)),
        )
    }

    /// A number above 0.
    pub fn positive(&self, number: &At<Number>, name: &str) -> Result<f64> {
        self.above_zero(number, number.value.0, name, "like 1")
    }

    /// Numbers above 0.
    pub fn all_positive<T>(&self, at: &At<T>, numbers: &[f64], name: &str) -> Result<()> {
        let check = |&number: &f64| self.above_zero(at, number, name, "like 1").map(|_| ());
        numbers.iter().try_for_each(check)
    }

    fn above_zero<T>(&self, at: &At<T>, value: f64, name: &str, like: &str) -> Result<f64> {
        if value >= SMALLEST {
            return Ok(value);
        }
        let what = match value > 0.0 {
            true => format!("{name} is below {SMALLEST:e}"),
            false => format!("{name} is {value}, which is not above 0"),
        };
        Err(self.refuse(at, what, format!("{name} is above 0, {like}")))
    }

    /// Linear RGB, each at least 0.
    pub fn colour(&self, colour: &At<Vector>) -> Result<[f64; 3]> {
        if colour.value.0.iter().all(|&c| c >= 0.0) {
            return Ok(colour.value.0);
        }
        let help = "linear red, green and blue are each at least 0, like [0.8, 0.8, 0.8]";
        Err(self.refuse(colour, "a colour is below 0", help))
    }

    /// A text that is not empty.
    pub fn text<'t>(&self, text: &'t At<String>, name: &str) -> Result<&'t str> {
        if text.value.trim().is_empty() {
            let what = format!("{name} is empty");
            return Err(self.refuse(text, what, format!("give {name}, or leave the key out")));
        }
        Ok(&text.value)
    }

    /// An optional text that is not empty.
    pub fn optional_text(&self, text: &Option<At<String>>, name: &str) -> Result<Option<String>> {
        let check = |text| self.text(text, name).map(str::to_string);
        text.as_ref().map(check).transpose()
    }

    /// The path of a file that is there, with one of these extensions.
    pub fn path(&self, file: &At<String>, extensions: [&str; 2]) -> Result<PathBuf> {
        let path = self.base.join(self.text(file, "the file's name")?);
        let extension = path
            .extension()
            .and_then(|e| e.to_str())
            .unwrap_or_default();
        if !extensions
            .iter()
            .any(|known| known.eq_ignore_ascii_case(extension))
        {
            let [a, b] = extensions;
            let what = format!("{} is neither a .{a} nor a .{b} file", quoted(&file.value));
            return Err(self.refuse(file, what, format!("name a .{a} or .{b} file")));
        }
        let problem = match files::length(&path) {
            Ok(_) => return Ok(path),
            // There, but a directory or a device.
            Err(error) if error.kind() == ErrorKind::InvalidInput && path.exists() => {
                error.to_string()
            }
            Err(error) => format!("cannot find this file: {error}"),
        };
        let folder = match self.base.as_os_str().is_empty() {
            true => "the current folder".to_string(),
            false => self.base.display().to_string(),
        };
        let help = format!("paths are relative to the scene file, that is to {folder}");
        Err(self.refuse(file, problem, help))
    }
}
