//! Helpers for all parts of the resolution: times in metres, positive numbers, colours, paths.

use std::fmt::Display;
use std::ops::Range;
use std::path::{Path, PathBuf};

use glam::DVec3;

use crate::error::{Error, Result};
use crate::io::gltf::{GltfLight, GltfTrack};
use crate::scene::at::At;
use crate::scene::inputs::{Inputs, Pose};
use crate::scene::limits::Wrong;
use crate::scene::memory;
use crate::scene::report::Report;
use crate::scene::values::{Number, Vector};
use crate::spacetime::units::{
    Acceleration, AngularRate, LARGEST, Length, SMALLEST, Speed, Time, quoted,
};
use crate::spacetime::{Direction, World};

/// The largest number of segments, times of a profile, or keyframes.
const LONGEST_LIST: usize = 100_000;

/// Factors on a bound, so that messages name a value of four digits that is safely on the right side of it.
pub(super) const BELOW: f64 = 0.999;
pub(super) const ABOVE: f64 = 1.001;

/// The extensions of glTF files.
pub(in crate::scene) const GLTF: &[&str] = &["glb", "gltf"];

/// The extensions of files of numbers.
pub(in crate::scene) const NUMBERS: &[&str] = &["npy", "npz"];

/// The extensions of files of spectra.
pub(in crate::scene) const SPECTRUM: &[&str] = &["csv", "txt"];

/// Whether `path` ends with one of these extensions.
pub(in crate::scene) fn has_extension(path: &Path, extensions: &[&str]) -> bool {
    let own = path.extension().and_then(|e| e.to_str());
    own.is_some_and(|own| extensions.iter().any(|e| e.eq_ignore_ascii_case(own)))
}

/// The context of a scene that is being resolved.
pub(crate) struct Context {
    /// The text, for error messages.
    pub report: Report,
    /// The external files that the text names.
    pub(in crate::scene) inputs: Inputs,
    /// Metres per second, above 0.
    pub speed_of_light: f64,
}

impl Context {
    pub(in crate::scene) fn new(report: Report, inputs: Inputs, c: &At<Speed>) -> Result<Self> {
        let speed_of_light = c.value.metres_per_second();
        if speed_of_light <= 0.0 {
            let what = format!("the speed of light {} is not above 0", c.value);
            return Err(report.refuse(&c.span, what, "any positive speed will do"));
        }
        Ok(Context {
            report,
            inputs,
            speed_of_light,
        })
    }

    /// The error for the value at `at`.
    pub fn refuse<T>(&self, at: &At<T>, what: impl Into<String>, help: impl Into<String>) -> Error {
        self.report.refuse(&at.span, what, help)
    }

    /// Refuses the value at `at` for what is wrong with it.
    pub fn checked<T>(&self, at: &At<T>, check: Result<(), Wrong>) -> Result<()> {
        check.map_err(|(what, help)| self.refuse(at, what, help))
    }

    /// The error for `second`, which cannot be combined with `first`.
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

    /// Refuses two keys if both are given.
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

    /// Refuses more than one of the `ways` to give a `thing`.
    pub fn only_one<const N: usize>(
        &self,
        thing: &str,
        ways: [(&str, Option<&Range<usize>>); N],
        help: &str,
    ) -> Result<()> {
        let mut said = ways.iter().filter_map(|(key, span)| Some((key, (*span)?)));
        // The given ones; of more than two, the first two are reported.
        let (Some((first, here)), Some((second, there))) = (said.next(), said.next()) else {
            return Ok(());
        };
        let what = format!("{thing} is given twice, as `{first}` and as `{second}`");
        Err(self
            .report
            .refuse_two(there, (here, "and here"), what, help))
    }

    /// Refuses lists that are too short or too long.
    pub fn bounded<T>(&self, at: &At<Vec<T>>, fewest: usize, name: &str) -> Result<()> {
        let count = at.value.len();
        if (fewest..=LONGEST_LIST).contains(&count) {
            return Ok(());
        }
        let few = if count < fewest {
            "too few"
        } else {
            "too many"
        };
        let what = format!("{count} {name} are {few}");
        Err(self.refuse(at, what, format!("give {fewest} to {LONGEST_LIST}")))
    }

    /// Refuses times that do not ascend, at the first that does not; `said` gives the place of the i-th.
    pub fn ascending<'a, T: Display + 'a>(
        &self,
        times: &[f64],
        said: impl Fn(usize) -> Option<&'a At<T>>,
    ) -> Result<()> {
        // Compared in metres, shown as written.
        let before = times.windows(2).position(|pair| pair[1] <= pair[0]);
        let pair = before.and_then(|before| Some((said(before)?, said(before + 1)?)));
        let Some((first, second)) = pair else {
            return Ok(());
        };
        let (earlier, later) = (&first.value, &second.value);
        let what = format!("the time {later} is not after that of the previous entry, {earlier}");
        let help = "give the entries in the order of their times, each time once";
        let other = (&first.span, "the entry before");
        Err(self.report.refuse_two(&second.span, other, what, help))
    }

    /// The unit vector of a direction, whose `name` is for messages.
    pub fn unit(&self, at: &At<Vector>, name: &str, help: &str) -> Result<DVec3> {
        let direction = Direction::<World>::new(at.value.vec()).map(Direction::unit);
        direction.ok_or_else(|| self.refuse(at, format!("{name} is the zero vector"), help))
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

    /// Edges of a box, above 0.
    pub fn positive_edges<T>(&self, at: &At<T>, edges: &[f64]) -> Result<()> {
        let check = |&edge: &f64| self.above_zero(at, edge, "an edge", "like 1").map(|_| ());
        edges.iter().try_for_each(check)
    }

    fn above_zero<T>(&self, at: &At<T>, value: f64, name: &str, like: &str) -> Result<f64> {
        if value >= SMALLEST {
            return Ok(value);
        }
        // NaN comes here, too.
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

    /// The path of an existing file with one of these extensions.
    pub fn path(&self, file: &At<String>, extensions: &[&str]) -> Result<PathBuf> {
        // First by its name, then by what was found when the inputs were read: the resolver opens no file.
        let base = &self.inputs.base;
        let path = base.join(self.text(file, "the file's name")?);
        if !has_extension(&path, extensions) {
            let what = format!(
                "{} is neither a .{} file",
                quoted(&file.value),
                extensions.join(" nor a .")
            );
            let help = format!("name a .{} file", extensions.join(" or ."));
            return Err(self.refuse(file, what, help));
        }
        let Some(problem) = self.inputs.problem(file) else {
            return Ok(path);
        };
        let folder = match base.as_os_str().is_empty() {
            true => "the current folder".to_string(),
            false => base.display().to_string(),
        };
        let help = format!("paths are relative to the scene file, that is to {folder}");
        Err(self.refuse(file, problem, self.remedy(file, help)))
    }

    /// What to do about the file named at `file`: the scene's advice if the file is missing, else `otherwise`.
    pub fn remedy(&self, file: &At<String>, otherwise: String) -> String {
        match self.inputs.remedy(file) {
            Some(said) => format!("the scene says: {said}\n{otherwise}"),
            None => otherwise,
        }
    }

    /// The pose of the camera in a glTF file.
    pub(in crate::scene) fn gltf_pose(&self, file: &At<String>) -> Result<Pose> {
        self.path(file, GLTF)?;
        self.pose_of(file)
    }

    /// The pose read from the file or folder named at `file`.
    pub(in crate::scene) fn pose_of(&self, file: &At<String>) -> Result<Pose> {
        let missing = || Err(self.refuse(file, "the camera of this file was not read", ""));
        self.inputs.pose(file).unwrap_or_else(missing)
    }

    /// The path of an animated node of a glTF file.
    pub(in crate::scene) fn gltf_track(&self, file: &At<String>) -> Result<GltfTrack> {
        self.path(file, GLTF)?;
        let missing = || Err(self.refuse(file, "the animation of this file was not read", ""));
        self.inputs.track(file).unwrap_or_else(missing)
    }

    /// A light of a glTF file.
    pub(in crate::scene) fn gltf_light(&self, file: &At<String>) -> Result<GltfLight> {
        self.path(file, GLTF)?;
        let missing = || Err(self.refuse(file, "the light of this file was not read", ""));
        self.inputs.light(file).unwrap_or_else(missing)
    }

    /// The rows of the spectrum in a text file.
    pub fn spectrum_table(&self, file: &At<String>) -> Result<Vec<[f64; 2]>> {
        self.path(file, SPECTRUM)?;
        let missing = || Err(self.refuse(file, "the spectrum of this file was not read", ""));
        self.inputs.table(file).unwrap_or_else(missing)
    }

    /// The numbers in a one-dimensional array.
    pub fn numbers(&self, file: &At<String>) -> Result<Vec<f64>> {
        self.path(file, NUMBERS)?;
        let missing = || Err(self.refuse(file, "the numbers of this file were not read", ""));
        self.inputs.numbers(file).unwrap_or_else(missing)
    }

    /// The object in memory that `name` refers to, looked up by `find`; `None` if it names a file.
    pub fn in_memory<T>(
        &self,
        name: &At<String>,
        find: impl FnOnce(&str) -> Option<T>,
    ) -> Result<Option<T>> {
        if !name.value.starts_with(memory::PREFIX) {
            return Ok(None);
        }
        find(&name.value).map(Some).ok_or_else(|| {
            let what =
                "this was given in memory by the program that made the scene, and is in no file";
            self.refuse(name, what, "name a file in its place")
        })
    }
}
