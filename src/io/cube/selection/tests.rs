use super::*;

/// An array in memory.
struct Array {
    sizes: Vec<usize>,
    samples: Vec<f64>,
}

impl Windows for Array {
    fn read(&mut self, window: &[Range<usize>], to: &mut Vec<f64>) -> Result<()> {
        to.clear();
        for (n, sample) in self.samples.iter().enumerate() {
            let mut rest = n;
            let mut inside = true;
            for (range, size) in window.iter().zip(&self.sizes).rev() {
                inside &= range.contains(&(rest % size));
                rest /= size;
            }
            if inside {
                to.push(*sample);
            }
        }
        Ok(())
    }

    fn together(&self) -> Vec<usize> {
        vec![2; self.sizes.len()]
    }
}

/// Sample n of an array is n: the selected samples follow from the index along each axis.
#[test]
fn axes_are_added_up_chosen_and_laid_out() {
    // (C 4, T 5, S 2, W 6 = 2 rows of 3, L 3).
    let sizes = [4u64, 5, 2, 6, 3];
    let mut array = Array {
        sizes: sizes.iter().map(|n| *n as usize).collect(),
        samples: (0..720).map(f64::from).collect(),
    };
    use Axis::{Channel, Choice, Column, Sum, Time};
    let taken = Taken {
        axes: &[Channel, Time, Sum, Column, Choice],
        choices: &[2],
        columns: Some(3),
        without_alpha: true,
        channels: None,
    };
    let selection = Selection::new(&sizes, Dtype::F64, &taken).unwrap();
    assert_eq!(selection.axes.to_string(), "C T H W");
    let path = Path::new("memory");
    let cube = selection.load(&mut array, path).unwrap();
    assert_eq!(cube.shape, [2, 3, 5, 3]);
    for n in 0..90 {
        let [i, j, t, c] = place_of(n, cube.shape);
        let of = |s: usize| ((((c * 5 + t) * 2 + s) * 6 + i * 3 + j) * 3 + 2) as f64;
        assert_eq!(cube.samples.get(n), Some(of(0) + of(1)), "{n}");
    }
    let mut bytes = Vec::new();
    let layout = selection.write_out(&mut array, path, &mut bytes).unwrap();
    assert_eq!((layout.sizes, bytes.len()), (vec![3, 5, 2, 3], 720));
}

#[test]
fn what_cannot_be_taken_is_refused_with_what_would_be_right() {
    use Axis::{Choice, Column, Row, Time};
    let refusal = |sizes: &[u64], axes: &[Axis], choices: &[usize]| {
        let taken = Taken {
            axes,
            choices,
            columns: None,
            without_alpha: false,
            channels: None,
        };
        let (what, help) = Selection::new(sizes, Dtype::F32, &taken).unwrap_err();
        format!("{what}; {help}")
    };
    for (message, wrong) in [
        (
            refusal(&[2, 3, 4], &[Row, Column], &[]),
            "3 axes, and 2 are named: H W",
        ),
        (refusal(&[2, 0, 4], &[Row, Column, Time], &[]), "no samples"),
        (
            refusal(&[1 << 30, 1 << 30, 4], &[Row, Column, Time], &[]),
            "more samples",
        ),
        (
            refusal(&[2, 3, 4], &[Row, Column, Choice], &[]),
            "array = \"H[2]\"",
        ),
        (
            refusal(&[2, 3, 4], &[Row, Column, Choice], &[4]),
            "no entry 4",
        ),
        (
            refusal(&[2, 3, 4], &[Row, Column, Time], &[1]),
            "more entries",
        ),
    ] {
        assert!(message.contains(wrong), "{message}");
    }
    assert_eq!(name_and_choices("H[3, 4]"), ("H", vec![3, 4]));
    assert_eq!(name_and_choices("a/b"), ("a/b", vec![]));
    assert_eq!(name_and_choices("a[x]"), ("a[x]", vec![]));
}
