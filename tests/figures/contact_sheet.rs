//! Contact sheets: the layout as data, and the resulting page.

use nullray::figures::contact_sheet::{Layout, Panel, Rect, SheetOptions, compose};
use nullray::io::image::RgbImage;

/// A picture of one colour.
fn panel(width: u32, height: u32, label: &str) -> Panel {
    let pixels = (width * height) as usize;
    Panel {
        picture: RgbImage {
            width,
            height,
            rgb: [200, 30, 10].repeat(pixels),
        },
        label: label.into(),
        new_row: false,
    }
}

fn panels(count: usize) -> Vec<Panel> {
    (0..count)
        .map(|i| panel(300, 200, &format!("β = 0.{i}")))
        .collect()
}

fn laid_out(panels: &[Panel], options: &SheetOptions) -> Layout {
    Layout::new(panels, options).unwrap()
}

fn contains(outer: Rect, inner: Rect) -> bool {
    outer.left <= inner.left
        && outer.top <= inner.top
        && inner.left + inner.width <= outer.left + outer.width
        && inner.top + inner.height <= outer.top + outer.height
}

fn overlap(a: Rect, b: Rect) -> bool {
    a.left < b.left + b.width
        && b.left < a.left + a.width
        && a.top < b.top + b.height
        && b.top < a.top + a.height
}

#[test]
fn cells_are_equal_apart_and_within_the_page() {
    for count in 1..=12 {
        for columns in [None, Some(1), Some(4), Some(100)] {
            let options = SheetOptions {
                title: Some("Figure 4: faster and faster".into()),
                columns,
            };
            let layout = laid_out(&panels(count), &options);
            let [width, height] = layout.size;
            let page = Rect {
                left: 0,
                top: 0,
                width,
                height,
            };
            assert_eq!(layout.cells.len(), count);
            for (i, cell) in layout.cells.iter().enumerate() {
                let first = layout.cells[0].frame;
                assert_eq!(
                    (cell.frame.width, cell.frame.height),
                    (first.width, first.height)
                );
                assert!(contains(page, cell.frame), "{count} {columns:?} {i}");
                for other in &layout.cells[..i] {
                    assert!(!overlap(cell.frame, other.frame), "{count} {columns:?} {i}");
                }
            }
        }
    }
}

#[test]
fn pictures_and_labels_lie_within_their_cells_and_labels_beneath_pictures() {
    let mut panels = panels(3);
    panels.push(panel(
        200,
        120,
        "a label that is much longer than its picture is wide, and then some more",
    ));
    let layout = laid_out(&panels, &SheetOptions::default());
    for cell in &layout.cells {
        assert!(contains(cell.frame, cell.picture));
        assert!(!cell.label.is_empty());
        let (left, right) = (cell.frame.left, cell.frame.left + cell.frame.width);
        let bottom = f64::from(cell.frame.top + cell.frame.height);
        for line in &cell.label {
            let [x, baseline] = line.middle;
            assert!(x - line.width / 2.0 >= f64::from(left), "{line:?}");
            assert!(x + line.width / 2.0 <= f64::from(right), "{line:?}");
            let top = baseline - 0.75 * line.size;
            assert!(
                top >= f64::from(cell.picture.top + cell.picture.height),
                "{line:?}"
            );
            // Room for the parts of letters below the baseline.
            assert!(baseline + 0.25 * line.size <= bottom, "{line:?} {bottom}");
        }
    }
    assert!(layout.cells[3].label.len() > 1);
}

#[test]
fn rows_are_as_high_as_their_own_pictures_and_labels() {
    let mut panels = panels(2);
    panels.push(panel(300, 90, "low"));
    panels.push(panel(300, 60, "lower"));
    let options = SheetOptions {
        title: None,
        columns: Some(2),
    };
    let cells = laid_out(&panels, &options).cells;
    let heights = cells.iter().map(|cell| cell.frame.height);
    let heights: Vec<u32> = heights.collect();
    assert_eq!(heights[0], heights[1]);
    assert_eq!(heights[2], heights[3]);
    assert_eq!(heights[0] - heights[2], 200 - 90);
    // Pictures of a row stand on one line.
    let bottom = |i: usize| cells[i].picture.top + cells[i].picture.height;
    assert_eq!(bottom(2), bottom(3));
    assert!(cells[2].frame.top > cells[0].frame.top + heights[0]);
}

#[test]
fn the_title_is_above_the_cells_and_within_the_page() {
    let options = SheetOptions {
        title: Some(
            "A title that is a good deal longer than the one picture that it stands above".into(),
        ),
        columns: None,
    };
    let layout = laid_out(&panels(1), &options);
    assert!(layout.title.len() > 1);
    for line in &layout.title {
        let [x, baseline] = line.middle;
        assert!(x - line.width / 2.0 >= 0.0 && x + line.width / 2.0 <= f64::from(layout.size[0]));
        assert!(baseline - line.size > 0.0);
        assert!(baseline + 0.3 * line.size < f64::from(layout.cells[0].frame.top));
    }
}

#[test]
fn without_a_number_of_columns_the_grid_is_nearly_square() {
    for (count, columns) in [(1, 1), (2, 2), (3, 2), (4, 2), (5, 3), (9, 3), (10, 4)] {
        let layout = laid_out(&panels(count), &SheetOptions::default());
        let top = layout.cells[0].frame.top;
        let in_first_row = layout.cells.iter().filter(|c| c.frame.top == top).count();
        assert_eq!(in_first_row, columns, "{count}");
    }
}

#[test]
fn several_panels_are_lettered_and_one_is_not() {
    let first = |layout: Layout| layout.cells[0].label[0].text.clone();
    assert_eq!(
        first(laid_out(&panels(2), &SheetOptions::default())),
        "(a) β = 0.0"
    );
    assert_eq!(
        first(laid_out(&panels(1), &SheetOptions::default())),
        "β = 0.0"
    );
}

#[test]
fn type_grows_with_the_pictures() {
    let size = |width| {
        let layout = laid_out(&[panel(width, 100, "x")], &SheetOptions::default());
        layout.cells[0].label[0].size
    };
    assert_eq!(size(800), 2.0 * size(400));
}

#[test]
fn small_pictures_are_enlarged_by_a_whole_factor() {
    let layout = laid_out(&[panel(32, 24, "small")], &SheetOptions::default());
    assert_eq!(layout.scale, 7);
    let picture = layout.cells[0].picture;
    assert_eq!([picture.width, picture.height], [7 * 32, 7 * 24]);
}

#[test]
fn pixels_of_pictures_are_copied_as_they_are() {
    let mut small = panel(2, 2, "");
    small.picture.rgb = vec![255, 0, 0, 0, 255, 0, 0, 0, 255, 10, 20, 30];
    let layout = laid_out(std::slice::from_ref(&small), &SheetOptions::default());
    let page = compose(std::slice::from_ref(&small), &SheetOptions::default()).unwrap();
    assert_eq!([page.width, page.height], layout.size);
    let Rect {
        left,
        top,
        width,
        height,
    } = layout.cells[0].picture;
    let pixel = |x: u32, y: u32| {
        let at = 3 * (y * page.width + x) as usize;
        page.rgb[at..at + 3].to_vec()
    };
    assert_eq!(pixel(left, top), [255, 0, 0]);
    assert_eq!(pixel(left + width - 1, top), [0, 255, 0]);
    assert_eq!(pixel(left, top + height - 1), [0, 0, 255]);
    assert_eq!(pixel(left + width - 1, top + height - 1), [10, 20, 30]);
    assert_eq!(pixel(left - 1, top), [255; 3]);
    assert_eq!(pixel(left + width, top + height - 1), [255; 3]);
}

#[test]
fn labels_leave_ink_where_the_layout_says() {
    let panels = panels(2);
    let layout = laid_out(&panels, &SheetOptions::default());
    let page = compose(&panels, &SheetOptions::default()).unwrap();
    for cell in &layout.cells {
        let line = &cell.label[0];
        let [x, baseline] = line.middle;
        let (from, to) = (x - line.width / 2.0, x + line.width / 2.0);
        let rows = (baseline - 0.7 * line.size) as u32..baseline as u32;
        let inked = rows.flat_map(|y| (from as u32..to as u32).map(move |x| (x, y)));
        let dark = inked.filter(|(x, y)| page.rgb[3 * (y * page.width + x) as usize] < 80);
        assert!(dark.count() > 20);
    }
}

#[test]
fn the_signs_of_figures_can_be_set() {
    let label = "β γ δ θ λ τ Δ Ω x′ · × − 30° 0–1";
    compose(&[panel(300, 10, label)], &SheetOptions::default()).unwrap();
}

#[test]
fn invalid_contact_sheets_are_refused() {
    let refusal = |panels: &[Panel], title: &str| {
        let options = SheetOptions {
            title: Some(title.into()),
            columns: None,
        };
        compose(panels, &options).unwrap_err().to_string()
    };
    assert!(refusal(&[], "").contains("without panels"));
    let missing = refusal(&[panel(9, 9, "slow 光")], "");
    assert!(missing.contains("'光' (U+5149)"), "{missing}");
    let missing = refusal(&[panel(9, 9, "slow")], "光");
    assert!(missing.contains("'光' (U+5149)"), "{missing}");
    let mut broken = panel(4, 4, "");
    broken.picture.rgb.pop();
    assert!(refusal(&[broken], "").contains("47 bytes"));
    let large: Vec<_> = (0..20).map(|_| panel(2000, 1, "x")).collect();
    let options = SheetOptions {
        title: None,
        columns: Some(20),
    };
    let error = compose(&large, &options).unwrap_err().to_string();
    assert!(error.contains("cannot be drawn"), "{error}");
}

#[test]
fn a_panel_may_begin_a_row() {
    // Rows of 3, 1 and 2 of at most 3 columns.
    let mut panels = panels(6);
    for k in [3, 4] {
        panels[k].new_row = true;
    }
    let options = SheetOptions {
        columns: Some(3),
        ..SheetOptions::default()
    };
    let layout = laid_out(&panels, &options);
    let tops: Vec<u32> = layout.cells.iter().map(|cell| cell.frame.top).collect();
    let lefts: Vec<u32> = layout.cells.iter().map(|cell| cell.frame.left).collect();
    assert!(tops[0] == tops[1] && tops[1] == tops[2] && tops[2] < tops[3]);
    assert!(tops[3] < tops[4] && tops[4] == tops[5]);
    assert!(lefts[0] == lefts[3] && lefts[3] == lefts[4] && lefts[1] == lefts[5]);
    let bottom = layout.cells[5].frame.top + layout.cells[5].frame.height;
    assert!(bottom < layout.size[1], "the page holds the last row");
}
