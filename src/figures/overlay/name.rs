//! Positions of objects' names: inside the visible part, as near to its middle as the name fits.

/// The objects that each pixel shows, in which names are placed.
#[derive(Debug)]
pub(super) struct Regions<'a> {
    /// Columns and rows.
    size: [usize; 2],
    /// Indices of objects, negative for none; row 0 at the top.
    objects: &'a [i32],
    /// Number of consecutive pixels in a row, starting with this one, that show the same object.
    runs: Vec<u32>,
}

/// The most places that are tried for a name.
const PLACES: usize = 400;

impl<'a> Regions<'a> {
    /// The regions of a picture of this size; `None` if `objects` has another number of pixels.
    pub fn new([width, height]: [u32; 2], objects: &'a [i32]) -> Option<Regions<'a>> {
        let size = [width, height].map(|side| side as usize);
        if size.contains(&0) || objects.len() != size[0] * size[1] {
            return None;
        }
        let mut runs = vec![1; objects.len()];
        // Pixels of the same object from here to the right, counted from the right.
        for i in (0..objects.len() - 1).rev() {
            if (i + 1) % size[0] != 0 && objects[i] == objects[i + 1] {
                runs[i] = runs[i + 1] + 1;
            }
        }
        Some(Regions {
            size,
            objects,
            runs,
        })
    }

    /// Middles of boxes of this width and height in which all pixels show the object, pixels: the one closest to the middle of its visible
    /// part first.
    pub fn places(&self, object: usize, [width, height]: [f64; 2]) -> Vec<[f64; 2]> {
        let shown = |i: &usize| usize::try_from(self.objects[*i]) == Ok(object);
        let all = (0..self.objects.len()).filter(shown);
        let (mut count, mut sum) = (0.0, [0.0; 2]);
        for i in all.clone() {
            count += 1.0;
            sum = [sum[0] + self.at(i)[0] as f64, sum[1] + self.at(i)[1] as f64];
        }
        let middle = sum.map(|sum: f64| sum / f64::max(count, 1.0) + 0.5);
        let [columns, rows] = [width, height].map(|side| side.max(1.0).ceil() as usize);
        // Boxes are tried at every quarter of their height.
        let step = (rows / 4).max(1);
        let tried = all.filter(|i| self.at(*i).iter().all(|place| place % step == 0));
        let fitting = tried.filter(|i| self.holds(*i, object, [columns, rows]));
        let half = [columns, rows].map(|side| 0.5 * side as f64);
        let middles = fitting.map(|i| [0, 1].map(|k| self.at(i)[k] as f64 + half[k]));
        let mut places: Vec<[f64; 2]> = middles.collect();
        let far = |place: &[f64; 2]| (place[0] - middle[0]).hypot(place[1] - middle[1]);
        places.sort_by(|a, b| far(a).total_cmp(&far(b)));
        // At most PLACES, evenly thinned.
        let thin = places.len().div_ceil(PLACES).max(1);
        places.into_iter().step_by(thin).collect()
    }

    fn at(&self, i: usize) -> [usize; 2] {
        [i % self.size[0], i / self.size[0]]
    }

    /// Whether all pixels of the box with `first` as its upper left one show the object.
    fn holds(&self, first: usize, object: usize, [columns, rows]: [usize; 2]) -> bool {
        (0..rows).all(|row| {
            let i = first + row * self.size[0];
            let shows = |shown: &i32| usize::try_from(*shown) == Ok(object);
            self.objects.get(i).is_some_and(shows) && self.runs[i] as usize >= columns
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stand_within_what_is_seen_of_their_object_and_near_its_middle() {
        // Object 0 is the ground, object 1 a bar over it with a part cut off by object 2.
        let size = [40u32, 20];
        let shown = |x: u32, y: u32| match (x, y) {
            (10..30, 5..15) if x < 24 => 1,
            (24..34, 5..15) => 2,
            _ => 0,
        };
        let objects: Vec<i32> = (0..800).map(|i| shown(i % 40, i / 40)).collect();
        let regions = Regions::new(size, &objects).unwrap();
        let places = regions.places(1, [8.0, 4.0]);
        // The middle of columns 10 to 23 and rows 5 to 14.
        assert_eq!(places[0], [17.0, 10.0]);
        assert!(
            places
                .iter()
                .all(|[x, y]| { (14.0..=20.0).contains(x) && (7.0..=13.0).contains(y) })
        );
        // An object that is too small for a name, or not visible, has no place for it.
        assert_eq!(regions.places(2, [11.0, 4.0]), Vec::<[f64; 2]>::new());
        assert_eq!(regions.places(7, [1.0, 1.0]), Vec::<[f64; 2]>::new());
        assert!(Regions::new([3, 3], &objects).is_none());
    }
}
