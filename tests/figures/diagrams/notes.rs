//! Notes below diagrams: what is left out, what is a projection, and where x points.

use nullray::figures::diagram::{self, Series};
use nullray::figures::drawing::{Drawing, Item};

use super::{laid_out, parsed};

const CAMERA: &str = "[camera]\neye = [0, 0, 6]\nlook_at = [0, 0, 0]\n";

fn object(name: &str, beta: [f64; 3], x: f64) -> String {
    format!(
        "[[object]]\nname = \"{name}\"\nshape = {{ box = {{ size = [1, 1, 1] }} }}\n\
         velocity = {{ beta = {beta:?} }}\norigin = {{ position = [{x}, 0, 0] }}\n"
    )
}

fn notes(text: &str) -> Vec<String> {
    let model = parsed(text).unwrap_or_else(|error| panic!("{error}"));
    let layout = diagram::layout(&model);
    layout.notes.into_iter().map(|note| note.text).collect()
}

fn texts(drawing: &Drawing) -> Vec<String> {
    let texts = drawing.items.iter().filter_map(|item| match item {
        Item::Text(text) => Some(text.text.text()),
        _ => None,
    });
    texts.collect()
}

#[test]
fn a_note_says_how_many_objects_are_left_out_and_how_to_draw_them() {
    let scene = |count: u32| {
        let objects = (0..count).map(|k| {
            object(
                &format!("o{k}"),
                [0.05 * f64::from(k), 0.0, 0.0],
                f64::from(k),
            )
        });
        CAMERA.to_string() + &objects.collect::<String>()
    };
    let said = |count: u32| {
        let all = notes(&scene(count)).into_iter();
        all.filter(|note| note.contains("objects"))
            .collect::<Vec<_>>()
    };
    assert_eq!(said(12), Vec::<String>::new());
    let [note] = &said(16)[..] else {
        panic!("one note")
    };
    assert!(note.starts_with("4 of 16 objects are left out"), "{note}");
    assert!(
        note.contains("[[diagram.worldline]]") && note.contains("of ="),
        "{note}"
    );
    // As drawn, and in what the note advises, any object may be had.
    let model = parsed(&scene(16)).unwrap();
    let drawing = diagram::draw(&diagram::layout(&model), &model.style).unwrap();
    assert!(
        texts(&drawing)
            .iter()
            .any(|text| text.starts_with("4 of 16"))
    );
    let advised = scene(16) + "[diagram]\nworldline = [{ name = \"last\", of = \"o15\" }]\n";
    assert_eq!(parsed(&advised).unwrap().lines.len(), 1);
}

#[test]
fn a_note_names_world_lines_that_leave_the_plane_and_the_axis_of_the_world_along_x() {
    let scene = CAMERA.to_string()
        + &object("mover", [0.0, 0.8, 0.0], 0.0)
        + &object("other", [0.5, 0.0, 0.0], 0.0);
    // x along the first that moves: along y of the world, across which `other` moves.
    let found = notes(&scene);
    assert!(
        found.iter().any(|note| note
            == "the world line of other leaves the plane of the diagram: its projection"),
        "{found:?}"
    );
    assert!(
        found
            .iter()
            .any(|note| note == "*x* is measured along +*y* of the world"),
        "{found:?}"
    );
    // Along x it is the other way round, and the axis is no news.
    let along_x = notes(&format!("{scene}[diagram]\ndirection = [2, 0, 0]\n"));
    assert!(
        along_x
            .iter()
            .any(|note| note.starts_with("the world line of mover leaves")),
        "{along_x:?}"
    );
    assert!(
        !along_x.iter().any(|note| note.contains("measured")),
        "{along_x:?}"
    );
    // Both directions are drawn in 2+1 dimensions.
    let room = notes(&format!("{scene}[diagram]\ndimensions = \"2+1\"\n"));
    assert!(
        !room.iter().any(|note| note.contains("world line")),
        "{room:?}"
    );
    assert!(
        room.iter().any(|note| note.contains("*y* along +*x*")),
        "{room:?}"
    );
}

#[test]
fn labels_of_the_axes_are_enough_to_say_where_x_points() {
    let text =
        "[diagram]\ndirection = [0, 0, -1]\nworldline = [{ name = \"a\", velocity = 0.5 }]\n";
    assert_eq!(notes(text), ["*x* is measured along −*z* of the world"]);
    assert_eq!(
        notes(&format!("{text}labels = [\"*ct*\", \"−*z*\"]\n")),
        Vec::<String>::new()
    );
    // 0.6 and 0.8, of any length.
    let oblique = text.replace("[0, 0, -1]", "[3, 0, 4]");
    assert_eq!(
        notes(&oblique),
        ["*x* is measured along (0.6, 0, 0.8) of the world"]
    );
}

#[test]
fn all_pictures_of_a_boost_have_the_notes_of_each() {
    // The ship moves along x, and along y so slowly; what rests in the world leaves the plane in the frame of a ship along y.
    let scene = CAMERA.replace(
        "[0, 0, 0]\n",
        "[0, 0, 0]\nvelocity = { beta = [0, 0.6, 0] }\n",
    ) + &object("rest", [0.0; 3], 1.0)
        + "[diagram]\ndirection = [1, 0, 0]\nanimation = { boost_to = \"camera\", frames = 4 }\n\
           worldline = [{ name = \"rest\", of = \"rest\" }, { name = \"camera\", of = \"camera\" }]\n";
    let model = parsed(&scene).unwrap();
    let pictures: Vec<Drawing> = Series::new(&model).unwrap().map(Result::unwrap).collect();
    assert_eq!(pictures.len(), 4);
    for picture in &pictures {
        assert_eq!(picture.height, pictures[0].height);
        let said = texts(picture);
        assert!(
            said.iter()
                .any(|text| text.contains("the world lines of rest and camera leave")),
            "{said:?}"
        );
    }
}

#[test]
fn notes_do_not_lie_on_each_other_or_on_a_legend() {
    let scene = CAMERA.to_string()
        + &object("mover", [0.0, 0.8, 0.0], 0.0)
        + &object("other", [0.5, 0.0, 0.0], 0.0)
        + "[diagram]\nstyle = { legend = true }\n";
    let model = parsed(&scene).unwrap();
    let layout = diagram::layout(&model);
    assert!(layout.notes.len() >= 2, "{:?}", layout.notes);
    let drawing = diagram::draw(&layout, &model.style).unwrap();
    let rects: Vec<_> = drawing
        .items
        .iter()
        .filter_map(|item| match item {
            Item::Text(text) => Some((text.text.text(), text.bounds().unwrap())),
            _ => None,
        })
        .collect();
    for (i, (a, p)) in rects.iter().enumerate() {
        assert!(
            p.max[1] <= drawing.height && p.min[0] >= 0.0 && p.max[0] <= drawing.width,
            "{a}"
        );
        for (b, q) in &rects[i + 1..] {
            let apart = (0..2).any(|k| p.max[k] <= q.min[k] || q.max[k] <= p.min[k]);
            assert!(apart, "{a} on {b}");
        }
    }
}

#[test]
fn a_diagram_of_one_direction_has_no_notes() {
    assert!(
        laid_out("worldline = [{ name = \"a\", velocity = 0.5 }]")
            .notes
            .is_empty()
    );
}
