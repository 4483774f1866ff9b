//! Files conform to their formats.

use nullray::figures::drawing::{Colour, Drawing, pdf, png, save, svg};

use super::pdf_reader::{content, objects};
use super::samples::{all, page};
use super::svg_reader::{Token, tokens};

#[test]
fn svg_files_are_well_formed() {
    for (name, drawing) in all() {
        let file = svg::write(&drawing).unwrap();
        assert!(tokens(&file).len() > 8, "{name}");
    }
}

#[test]
fn svg_files_say_their_size_and_title() {
    let drawing = Drawing {
        width: 120.5,
        ..page("A < B & \"C\"", Vec::new())
    };
    let tokens = tokens(&svg::write(&drawing).unwrap());
    let Token::Start(_, attributes, _) = &tokens[0] else {
        panic!("{tokens:?}")
    };
    assert_eq!(attributes["width"], "120.5pt");
    assert_eq!(attributes["viewBox"], "0 0 120.5 60");
    assert_eq!(tokens[2], Token::Text("A < B & \"C\"".to_owned()));
}

#[test]
fn svg_text_has_the_given_characters() {
    let labels = all()
        .into_iter()
        .find(|(name, _)| *name == "labels")
        .unwrap()
        .1;
    let file = svg::write(&labels).unwrap();
    let labelled = tokens(&file).into_iter().filter_map(|token| match token {
        Token::Start(_, attributes, _) => attributes.get("aria-label").cloned(),
        _ => None,
    });
    let labelled: Vec<String> = labelled.collect();
    let expected = ["ct′ = γ(ct − βx)", "x_A^2 + 10^{−9} s", "Alice’s", "Δτ ⊥ Q"];
    assert_eq!(labelled, expected);
}

#[test]
fn svg_numbers_have_at_most_four_decimals() {
    for (name, drawing) in all() {
        let file = svg::write(&drawing).unwrap();
        let decimals = file.split('.').skip(1);
        let most = decimals
            .map(|rest| rest.bytes().take_while(u8::is_ascii_digit).count())
            .max();
        assert!(most <= Some(4), "{name}");
        assert!(!file.contains("NaN") && !file.contains("inf"), "{name}");
    }
}

#[test]
fn the_table_of_a_pdf_file_leads_to_its_objects() {
    for (name, drawing) in all() {
        assert_eq!(objects(&pdf::write(&drawing).unwrap()).len(), 5, "{name}");
    }
}

#[test]
fn pdf_files_say_their_size_title_and_producer_and_no_date() {
    let file = pdf::write(&page("World lines", Vec::new())).unwrap();
    let objects = objects(&file);
    let object = |number| String::from_utf8_lossy(objects[&number]).into_owned();
    assert!(
        object(3).contains("/MediaBox [0 0 120 60]"),
        "{}",
        object(3)
    );
    assert!(object(5).contains("/Title (World lines)"), "{}", object(5));
    let producer = concat!("(nullray ", env!("CARGO_PKG_VERSION"), ")");
    assert!(
        object(5).contains(producer) && !object(5).contains("Date"),
        "{}",
        object(5)
    );
}

#[test]
fn pdf_opacities_are_defined_where_they_are_used() {
    let hatches = all()
        .into_iter()
        .find(|(name, _)| *name == "hatches")
        .unwrap()
        .1;
    let file = pdf::write(&hatches).unwrap();
    let page = String::from_utf8_lossy(objects(&file)[&3]).into_owned();
    for word in content(&file)
        .split_whitespace()
        .filter(|word| word.starts_with('/'))
    {
        assert!(page.contains(&format!("{word} <<")), "{word}: {page}");
    }
}

/// The data of the chunk `kind` of a PNG file.
fn chunk<'a>(png: &'a [u8], kind: &[u8; 4]) -> &'a [u8] {
    let mut rest = &png[8..];
    loop {
        let length = u32::from_be_bytes(rest[..4].try_into().unwrap()) as usize;
        if &rest[4..8] == kind {
            return &rest[8..8 + length];
        }
        rest = &rest[12 + length..];
    }
}

#[test]
fn png_files_say_how_many_pixels_are_a_metre() {
    let picture = png::render(&page("", Vec::new()), 300.0 / 72.0).unwrap();
    assert_eq!((picture.width, picture.height), (500, 250));
    let file = png::write(&picture).unwrap();
    // 300 / 0.0254, both ways, in metres.
    let expected = [&11_811u32.to_be_bytes()[..], &11_811u32.to_be_bytes(), &[1]].concat();
    assert_eq!(chunk(&file, b"pHYs"), expected);
}

#[test]
fn png_files_have_alpha_only_where_it_is_needed() {
    let colour_type = |background| {
        let drawing = Drawing {
            background,
            ..page("", Vec::new())
        };
        let file = png::write(&png::render(&drawing, 1.0).unwrap()).unwrap();
        chunk(&file, b"IHDR")[9]
    };
    assert_eq!(colour_type(Colour::WHITE), 2);
    assert_eq!(colour_type(Colour::TRANSPARENT), 6);
}

#[test]
fn a_translucent_background_keeps_its_colour() {
    let background = Colour::rgb(255, 255, 0).with_alpha(128);
    let drawing = Drawing {
        background,
        ..page("", Vec::new())
    };
    let picture = png::render(&drawing, 1.0).unwrap();
    assert_eq!(picture.rgba[..4], [255, 255, 0, 128]);
}

#[test]
fn equal_drawings_are_equal_files() {
    for ((name, one), (_, other)) in all().into_iter().zip(all()) {
        assert_eq!(
            svg::write(&one).unwrap(),
            svg::write(&other).unwrap(),
            "{name}"
        );
        assert_eq!(
            pdf::write(&one).unwrap(),
            pdf::write(&other).unwrap(),
            "{name}"
        );
        let png = |drawing| png::write(&png::render(drawing, 2.0).unwrap()).unwrap();
        assert_eq!(png(&one), png(&other), "{name}");
    }
}

#[test]
fn files_are_saved_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("page.svg");
    let file = svg::write(&page("", Vec::new())).unwrap();
    save(&path, &file).unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), file);
    assert_eq!(folder.path().read_dir().unwrap().count(), 1);
}
