//! The order of an array's axes, and the conversion to that of a cube: (H, W, T, C).

use std::fmt;
use std::str::FromStr;

use crate::Error;

/// The advice about axes.
#[cfg(any(feature = "hdf5", feature = "zarr"))]
pub(super) const NAME_AXES: &str = "name every axis of the array in `axes`, like \"T H W\": H rows, W columns, T time bins, C channels, \
     S entries that are added up, L entries of which one is chosen, 1 an axis of one entry";

/// The meaning of the entries along an axis of an array.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Axis {
    /// `H`: rows, from the top.
    Row,
    /// `W`: columns, from the left.
    Column,
    /// `T`: time bins.
    Time,
    /// `C`: channels.
    Channel,
    /// `1`: an axis of one entry, with no meaning.
    Single,
    /// `S`: entries to sum over, like orders of bounces.
    Sum,
    /// `L`: entries of which one is selected by its number, such as points lit by a laser.
    Choice,
}

impl Axis {
    const ALL: [(Axis, char); 7] = [
        (Axis::Row, 'H'),
        (Axis::Column, 'W'),
        (Axis::Time, 'T'),
        (Axis::Channel, 'C'),
        (Axis::Single, '1'),
        (Axis::Sum, 'S'),
        (Axis::Choice, 'L'),
    ];

    /// By its name in files.
    #[cfg(any(feature = "hdf5", feature = "zarr"))]
    fn called(name: &str) -> Option<Axis> {
        match name.trim().to_ascii_lowercase().as_str() {
            "h" | "y" | "row" | "rows" | "height" => Some(Axis::Row),
            "w" | "x" | "col" | "cols" | "column" | "columns" | "width" => Some(Axis::Column),
            "t" | "time" | "times" | "bin" | "bins" | "time_bin" | "time_bins" => Some(Axis::Time),
            "c" | "channel" | "channels" | "colour" | "color" | "rgb" => Some(Axis::Channel),
            "1" => Some(Axis::Single),
            _ => None,
        }
    }

    fn letter(self) -> char {
        let row = Axis::ALL.iter().find(|(axis, _)| *axis == self);
        row.map_or('1', |(_, letter)| *letter)
    }
}

/// The order of an array's axes, slowest in memory first: numpy's order. It has rows and columns, and at most one axis of time and one of
/// channels; without time it is a steady picture.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Axes(Vec<Axis>);

impl Axes {
    /// (H, W, T), or with channels (H, W, T, C): the default for an array of these sizes.
    ///
    /// # Errors
    /// It could just as well be something else: what is ambiguous, and what to do about it.
    pub(super) fn assumed(sizes: &[usize]) -> Result<Axes, (String, &'static str)> {
        if let [h, w, last @ (3 | 4)] = *sizes
            && h.min(w) >= 8
        {
            let what = format!(
                "an array of shape {sizes:?} is probably a colour picture, but may be a cube of {last} time bins"
            );
            let help =
                "say which in `axes`: \"H W C\" is a steady picture, \"H W T\" a cube in time";
            return Err((what, help));
        }
        let all = [Axis::Row, Axis::Column, Axis::Time, Axis::Channel];
        match sizes.len() {
            count @ (3 | 4) => Ok(Axes(all[..count].to_vec())),
            _ => Err((
                format!("an array of shape {sizes:?} is not a cube"),
                "a cube has three or four axes, (H, W, T) or (H, W, T, C); for any others name them in `axes`, \
                 like \"H W\" for a steady picture",
            )),
        }
    }

    /// From the names that a file gives to all of its axes; `None` if it gives no names, or only the numbers that libraries assign by
    /// default.
    ///
    /// # Errors
    /// Unknown names: what they are, and what to do about it.
    #[cfg(any(feature = "hdf5", feature = "zarr"))]
    pub(super) fn by_names(names: &[String]) -> Result<Option<Axes>, (String, String)> {
        let is_number = |name: &str| {
            let digits = name
                .trim_start_matches("phony_dim_")
                .trim_start_matches("dim_");
            digits.chars().all(|c| c.is_ascii_digit())
        };
        if names.iter().all(|name| is_number(name.trim())) {
            return Ok(None);
        }
        let axes: Option<Vec<Axis>> = names.iter().map(|name| Axis::called(name)).collect();
        // Via text, which refuses axes that are missing or repeated.
        let axes = axes.and_then(|axes| Axes(axes).to_string().parse().ok());
        axes.map(Some).ok_or_else(|| {
            let shown: Vec<&str> = (names.iter())
                .map(|name| if name.is_empty() { "(no name)" } else { name })
                .collect();
            (
                format!(
                    "its axes are called {}, which are unknown names",
                    shown.join(", ")
                ),
                format!("{NAME_AXES}; or call them y, x, time and channel in the file"),
            )
        })
    }

    /// For each axis, its position in (H, W, T, C).
    pub(super) fn slots(&self) -> Vec<Option<usize>> {
        self.0.iter().map(|axis| slot(*axis)).collect()
    }

    /// The last axis first.
    pub(super) fn reversed(mut self) -> Axes {
        self.0.reverse();
        self
    }

    /// The axes, the slowest first.
    #[cfg(any(feature = "hdf5", feature = "zarr"))]
    pub(super) fn list(&self) -> &[Axis] {
        &self.0
    }

    /// Axes in this order, which has rows and columns.
    #[cfg(any(feature = "hdf5", feature = "zarr"))]
    pub(super) fn of(axes: Vec<Axis>) -> Axes {
        Axes(axes)
    }

    /// (H, W): those of a single picture.
    pub(super) fn of_picture() -> Axes {
        Axes(vec![Axis::Row, Axis::Column])
    }

    /// (T, H, W): those of a folder of frames.
    pub(super) fn of_frames() -> Axes {
        Axes(vec![Axis::Time, Axis::Row, Axis::Column])
    }

    /// (H, W, T).
    pub(super) fn of_array() -> Axes {
        Axes(vec![Axis::Row, Axis::Column, Axis::Time])
    }

    /// With an axis of channels, the fastest, unless there is one.
    pub(super) fn with_channels(mut self) -> Axes {
        if !self.0.contains(&Axis::Channel) {
            self.0.push(Axis::Channel);
        }
        self
    }

    /// (H, W, T, C): those of a cube in memory.
    pub(super) fn all() -> Axes {
        Axes(vec![Axis::Row, Axis::Column, Axis::Time, Axis::Channel])
    }

    /// Whether there is an axis of time.
    pub fn has_time(&self) -> bool {
        self.0.contains(&Axis::Time)
    }
}

impl fmt::Display for Axes {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let letters: Vec<String> = self.0.iter().map(|a| a.letter().to_string()).collect();
        f.write_str(&letters.join(" "))
    }
}

impl FromStr for Axes {
    /// The error message.
    type Err = String;

    /// From letters like `T H W`, with or without blanks or commas between them.
    fn from_str(text: &str) -> Result<Axes, String> {
        let mut axes = Vec::new();
        for letter in text.chars().filter(|c| !matches!(c, ' ' | ',')) {
            let known = |(_, known): &&(Axis, char)| letter.to_ascii_uppercase() == *known;
            let Some((axis, _)) = Axis::ALL.iter().find(known) else {
                return Err(format!("{letter:?} is not the letter of an axis"));
            };
            let is_one_of_many = matches!(axis, Axis::Single | Axis::Sum | Axis::Choice);
            if !is_one_of_many && axes.contains(axis) {
                return Err(format!("the axis {letter} is named twice"));
            }
            axes.push(*axis);
        }
        for (axis, name) in [(Axis::Row, "rows (H)"), (Axis::Column, "columns (W)")] {
            if !axes.contains(&axis) {
                return Err(format!("there are no {name}"));
            }
        }
        Ok(Axes(axes))
    }
}

/// The mapping from samples in the order of a file to a cube's.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Arrangement {
    /// H, W, T, C of the cube.
    pub shape: [usize; 4],
    /// Per axis of the file, the slowest first: its size, and how far apart in the cube its entries are.
    axes: Vec<(usize, usize)>,
}

impl Arrangement {
    /// For an array with these sizes, whose product is known to fit memory, in the order of the file (slowest axis first).
    ///
    /// # Errors
    /// What is wrong: the number of axes, or the size of an axis that should have one entry.
    pub fn new(sizes: &[usize], axes: &[Axis]) -> Result<Arrangement, String> {
        if sizes.len() != axes.len() {
            return Err(format!(
                "an array of shape {sizes:?} has {} axes, and {} are named",
                sizes.len(),
                axes.len()
            ));
        }
        let mut shape = [1; 4];
        for (&axis, &size) in axes.iter().zip(sizes) {
            match slot(axis) {
                Some(slot) => shape[slot] = size,
                None if size == 1 => {}
                None if axis == Axis::Single => {
                    return Err(format!(
                        "an axis named 1 has {size} entries in an array of shape {sizes:?}"
                    ));
                }
                None => {
                    return Err(format!(
                        "an axis named {} is for HDF5 and Zarr arrays only: it has {size} entries in an array of shape {sizes:?}",
                        axis.letter()
                    ));
                }
            }
        }
        let [_, w, t, c] = shape;
        let strides = [w * t * c, t * c, c, 1];
        let apart = |&axis: &Axis| slot(axis).map_or(0, |slot| strides[slot]);
        Ok(Arrangement {
            shape,
            axes: sizes.iter().copied().zip(axes.iter().map(apart)).collect(),
        })
    }

    /// For an array whose header gives `shape`: in the order of the file, which Fortran order reverses.
    pub fn of(shape: &[usize], axes: &Axes, fortran_order: bool) -> Result<Arrangement, String> {
        if !fortran_order {
            return Arrangement::new(shape, &axes.0);
        }
        let sizes: Vec<_> = shape.iter().rev().copied().collect();
        let axes: Vec<_> = axes.0.iter().rev().copied().collect();
        Arrangement::new(&sizes, &axes)
    }

    /// Whether samples are in the same order in the file as in the cube.
    pub fn is_plain(&self) -> bool {
        let mut apart = 1;
        self.axes.iter().rev().all(|&(size, stride)| {
            let fits = size == 1 || stride == apart;
            apart *= size;
            fits
        })
    }

    /// Copies `piece`, the samples of the file from the `first` on, to their places in `cube`.
    pub fn put<T: Copy>(&self, first: usize, piece: &[T], cube: &mut [T]) {
        let (mut counts, mut place) = self.counts(first);
        for sample in piece {
            if let Some(slot) = cube.get_mut(place) {
                *slot = *sample;
            }
            // Moves on by one sample: increments the fastest axis that is not at its end, and resets those below it.
            for (count, &(size, stride)) in counts.iter_mut().zip(&self.axes).rev() {
                *count += 1;
                place += stride;
                if *count < size {
                    break;
                }
                place -= size * stride;
                *count = 0;
            }
        }
    }

    /// Calls `take` with the position in the cube of each sample of the file, in the file's order.
    pub fn each_place(
        &self,
        mut take: impl FnMut(usize) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let mut counts = vec![0; self.axes.len()];
        let mut place = 0;
        for _ in 0..self.axes.iter().map(|axis| axis.0).product() {
            take(place)?;
            for (count, &(size, stride)) in counts.iter_mut().zip(&self.axes).rev() {
                *count += 1;
                place += stride;
                if *count < size {
                    break;
                }
                place -= size * stride;
                *count = 0;
            }
        }
        Ok(())
    }

    /// Where the `index`-th sample of the file lies in the cube.
    pub fn place(&self, index: usize) -> usize {
        self.counts(index).1
    }

    /// The index along each axis of the file's `index`-th sample, and its place in the cube.
    fn counts(&self, mut index: usize) -> (Vec<usize>, usize) {
        let mut counts = vec![0; self.axes.len()];
        let mut place = 0;
        for (count, &(size, stride)) in counts.iter_mut().zip(&self.axes).rev() {
            *count = index % size;
            index /= size;
            place += *count * stride;
        }
        (counts, place)
    }
}

/// The position of an axis in (H, W, T, C).
fn slot(axis: Axis) -> Option<usize> {
    match axis {
        Axis::Row => Some(0),
        Axis::Column => Some(1),
        Axis::Time => Some(2),
        Axis::Channel => Some(3),
        Axis::Single | Axis::Sum | Axis::Choice => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_are_read_with_and_without_blanks() {
        for text in ["T H W", "T,H,W", "thw", " T  H W "] {
            assert_eq!(text.parse::<Axes>().unwrap().to_string(), "T H W");
        }
        for (text, wrong) in [
            ("T H X", "'X'"),
            ("T H H W", "twice"),
            ("T W", "rows"),
            ("", "rows"),
            ("H T C", "columns"),
        ] {
            let error = text.parse::<Axes>().unwrap_err();
            assert!(error.contains(wrong), "{text}: {error}");
        }
    }

    /// Sample (i, j, k, c) of a cube of shape (2, 3, 4, 3) is its own index in C order; each order of axes is
    /// filled by its definition, index by index, and read back in pieces.
    #[test]
    fn every_order_gives_the_cube_back() {
        let shape = [2, 3, 4, 3];
        for text in ["H W T C", "T H W C", "C T H W", "W C H T", "1 T C W 1 H"] {
            let axes: Axes = text.parse().unwrap();
            let slots: Vec<_> = axes.0.iter().map(|&a| slot(a)).collect();
            let sizes: Vec<_> = slots.iter().map(|s| s.map_or(1, |s| shape[s])).collect();
            let mut file = vec![0; 72];
            for n in 0..72 {
                let index = [n / 36, n / 12 % 3, n / 3 % 4, n % 3];
                let place = slots.iter().zip(&sizes).fold(0, |place, (slot, size)| {
                    place * size + slot.map_or(0, |s| index[s])
                });
                file[place] = n;
            }
            for fortran in [false, true] {
                let mut said = sizes.clone();
                let mut axes = axes.clone();
                if fortran {
                    said.reverse();
                    axes.0.reverse();
                }
                let arrangement = Arrangement::of(&said, &axes, fortran).unwrap();
                assert_eq!(arrangement.shape, shape);
                assert_eq!(arrangement.is_plain(), text == "H W T C");
                let mut cube = vec![0; 72];
                for (number, piece) in file.chunks(7).enumerate() {
                    arrangement.put(7 * number, piece, &mut cube);
                }
                assert!(cube.iter().copied().eq(0..72), "{text}");
                assert_eq!(arrangement.place(5), file[5]);
            }
        }
    }
}
