use super::super::outline::Segment;
use super::*;

fn width(markup: &str) -> f64 {
    RichText::parse(markup).unwrap().width(1000.0).unwrap()
}

#[test]
fn scripts_are_smaller() {
    assert!((width("x_1") - width("x") - 0.7 * width("1")).abs() < 1e-9);
    assert!((width("x^1") - width("x") - 0.7 * width("1")).abs() < 1e-9);
}

#[test]
fn scripts_of_both_kinds_stand_above_each_other() {
    assert_eq!(width("x_1^{22}"), width("x^{22}"));
    assert_eq!(width("x^{22}_1"), width("x^{22}"));
    assert!((width("x^{22}_1y") - width("x^{22}") - width("y")).abs() < 1e-9);
}

#[test]
fn a_third_script_goes_on_after_the_two() {
    assert!((width("x_1^2_3") - width("x_1_1")).abs() < 1e-9);
}

#[test]
fn leaning_letters_are_kept_clear_of_what_stands_upright_or_high() {
    let apart = |markup, then: f64| width(markup) - width("*H*") - then;
    let overhang = apart("*H*(", width("("));
    assert!((100.0..110.0).contains(&overhang), "{overhang}");
    assert!((apart("*H*^2", 0.7 * width("2")) - overhang).abs() < 1e-9);
    assert!(apart("*H*_2", 0.7 * width("2")).abs() < 1e-9);
    assert!(apart("*H* ", width(" ")).abs() < 1e-9);
}

#[test]
fn bounds_tell_sub_from_superscripts() {
    let y = |markup| {
        let rect = RichText::parse(markup).unwrap().bounds(1000.0).unwrap();
        (rect.min[1], rect.max[1])
    };
    let (line, sub, sup) = (y("1"), y("{}_1"), y("{}^1"));
    assert!((sub.0 - (0.7 * line.0 + 180.0)).abs() < 1e-9, "{sub:?}");
    assert!((sup.0 - (0.7 * line.0 - 330.0)).abs() < 1e-9, "{sup:?}");
}

#[test]
fn plain_text_tells_scripts() {
    let text = RichText::parse("*x*_A = 10^{*n* - 1}").unwrap().text();
    assert_eq!(text, "x_A = 10^{n − 1}");
}

#[test]
fn a_character_that_neither_font_has_is_named_with_its_text() {
    let error = RichText::parse("*c* 光").unwrap_err().to_string();
    assert!(
        error.contains("'光' (U+5149)") && error.contains("c 光"),
        "{error}"
    );
}

fn italic(text: &str) -> RichText {
    RichText::parse(&format!("*{text}*")).unwrap()
}

#[test]
fn the_fonts_have_what_physics_needs() {
    let text = "aZ09 γβτλΔΩµ′″−·×±°…²³¹⁰⁴⁻⁺₀₁₂₉→≈≤≥∞½√∥";
    RichText::plain(text).unwrap().outline(10.0).unwrap();
    italic(text).outline(10.0).unwrap();
    RichText::plain("⊥").unwrap().outline(10.0).unwrap();
}

#[test]
fn what_italics_lack_is_set_upright() {
    let italic = italic("⊥").outline(10.0).unwrap();
    assert_eq!(italic, RichText::plain("⊥").unwrap().outline(10.0).unwrap());
}

#[test]
fn a_missing_character_is_named() {
    let error = RichText::plain("光 slow").unwrap_err();
    assert!(error.to_string().contains("'光' (U+5149)"), "{error}");
    assert!(error.to_string().contains("光 slow"), "{error}");
}

#[test]
fn widths_are_the_sum_of_advances_and_kerning() {
    // From the font's tables: figures are 465 units wide, and not kerned among themselves.
    let eleven = RichText::plain("11").unwrap().width(1000.0).unwrap();
    assert_eq!(
        eleven,
        2.0 * RichText::plain("1").unwrap().width(1000.0).unwrap()
    );
    let pair = |text| RichText::plain(text).unwrap().width(1000.0).unwrap();
    assert!(
        pair("AV") < pair("A") + pair("V") - 50.0,
        "A and V move together"
    );
    assert_eq!(
        pair("AV") * 2.0,
        RichText::plain("AV").unwrap().width(2000.0).unwrap()
    );
}

#[test]
fn an_upright_i_stands_on_the_baseline() {
    let outline = RichText::plain("I").unwrap().outline(1000.0).unwrap();
    let ends = outline.segments.iter().filter_map(|s| match s {
        Segment::Move(p) | Segment::Line(p) => Some(p[1]),
        Segment::Quadratic(_, p) | Segment::Cubic(_, _, p) => Some(p[1]),
        Segment::Close => None,
    });
    let (low, high) = ends.fold((0.0, 0.0), |(l, h): (f64, f64), y| (l.min(y), h.max(y)));
    // Capital height of the font: 0.645 em; y runs down.
    assert!(
        (-660.0..=-635.0).contains(&low) && high <= 3.0,
        "{low} {high}"
    );
}
