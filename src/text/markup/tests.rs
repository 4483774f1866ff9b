use super::*;

/// The runs as text: italics between slashes, scripts after their mark.
fn runs(markup: &str) -> String {
    let shown = parse(markup).unwrap().into_iter().map(|run| {
        let mark = match run.level {
            Level::Line => "",
            Level::Subscript => "_",
            Level::Superscript => "^",
        };
        match run.style {
            Style::Upright => format!("{mark}({})", run.text),
            Style::Italic => format!("{mark}/{}/", run.text),
        }
    });
    shown.collect()
}

fn refusal(markup: &str) -> String {
    parse(markup).unwrap_err().to_string()
}

#[test]
fn braces_within_braces_have_a_limit() {
    let nested = |depth| format!("{}x{}", "{".repeat(depth), "}".repeat(depth));
    assert_eq!(runs(&nested(DEEPEST)), "(x)");
    let refused = refusal(&nested(DEEPEST + 1));
    assert!(refused.contains("too many braces"), "{refused}");
    refusal(&nested(100_000));
}

#[test]
fn italics_stand_between_asterisks() {
    assert_eq!(runs("at *ct* = 5"), "(at )/ct/( = 5)");
}

#[test]
fn scripts_take_one_character_or_a_group() {
    assert_eq!(runs("*x*_A"), "/x/_(A)");
    assert_eq!(runs("10^{9 m}s"), "(10)^(9 m)(s)");
    assert_eq!(runs("x_\\gamma"), "(x)_(γ)");
}

#[test]
fn italics_may_stand_in_scripts_and_around_them() {
    assert_eq!(runs("x_{*i*}"), "(x)_/i/");
    assert_eq!(runs("*x_i*"), "/x/_/i/");
}

#[test]
fn quotes_are_primes_except_within_words() {
    assert_eq!(runs("*ct*'"), "/ct/(′)");
    assert_eq!(runs("S' and S''"), "(S′ and S″)");
    assert_eq!(runs("Alice's"), "(Alice’s)");
    assert_eq!(runs("*x't*"), "/x′t/");
}

#[test]
fn hyphens_are_minus_signs_except_after_words() {
    assert_eq!(runs("10^{-9}"), "(10)^(−9)");
    assert_eq!(runs("a - b"), "(a − b)");
    assert_eq!(runs("space-time"), "(space-time)");
}

#[test]
fn names_are_signs_and_escapes_are_characters() {
    assert_eq!(runs("\\Delta{}t \\times 2"), "(Δt × 2)");
    assert_eq!(runs("\\*\\_\\^\\\\\\'\\-\\{\\}"), "(*_^\\'-{})");
}

#[test]
fn every_sign_is_in_the_font() {
    for (name, _) in SIGNS {
        super::super::RichText::parse(&format!("\\{name}*\\{name}*")).unwrap();
    }
}

#[test]
fn italics_that_do_not_end_are_refused_where_they_begin() {
    let error = refusal("5 * 3");
    assert!(
        error.contains("5 * 3") && error.contains("character 3"),
        "{error}"
    );
}

#[test]
fn braces_must_close() {
    assert!(refusal("x_{a").contains("character 3"));
    assert!(refusal("a}").contains("closes nothing"));
}

#[test]
fn scripts_of_scripts_and_of_nothing_are_refused() {
    assert!(refusal("x^{a_b}").contains("no scripts"));
    assert!(refusal("x^").contains("is empty"));
    assert!(refusal("x_ a").contains("is empty"));
}

#[test]
fn an_unknown_name_is_refused() {
    let error = refusal("\\gammat");
    assert!(error.contains("\\gammat"), "{error}");
}

#[test]
fn a_lone_backslash_is_refused() {
    assert!(refusal("a\\").contains("character 2"));
}
