//! Characters in LaTeX, for any of its engines: mathematical symbols are set as such, and characters in other positions of the old font
//! encoding (OT1), such as `<`, are set by name.
//!
//! All characters of the font are supported, though some letters (ą, đ, þ, „) need `\usepackage[T1]{fontenc}` with pdfTeX.

use super::markup::signs;

/// The characters of `text`.
pub(super) fn words(text: &str) -> String {
    let mut all = String::new();
    for c in text.chars() {
        // Two hyphens would be a dash.
        if c == '-' && all.ends_with('-') {
            all.push_str("{}");
        }
        all.push_str(&word(c));
    }
    all
}

fn word(c: char) -> String {
    match (c, mathematics(c), letters(c)) {
        (_, Some(sign), _) => format!("${sign}$"),
        (_, _, Some(letters)) => letters.into(),
        ('#' | '$' | '%' | '&' | '_' | '{' | '}', ..) => format!("\\{c}"),
        _ => c.to_string(),
    }
}

/// Between dollars.
fn mathematics(c: char) -> Option<String> {
    if let Some(script) = script(c) {
        return Some(script);
    }
    let sign = match c {
        '<' | '>' | '|' => return Some(c.into()),
        '′' => "'",
        '″' => "''",
        '‴' => "'''",
        '−' => "-",
        '°' => "^\\circ",
        '√' => "\\surd",
        // The shapes of the font.
        'ε' => "\\varepsilon",
        'φ' => "\\varphi",
        'ϕ' => "\\phi",
        'ϑ' => "\\vartheta",
        'ς' => "\\varsigma",
        'ο' => "o",
        'ħ' => "\\hbar",
        'ℓ' => "\\ell",
        '∆' => "\\Delta",
        '∇' => "\\nabla",
        '∑' => "\\sum",
        '∫' => "\\int",
        '∝' => "\\propto",
        '∼' => "\\sim",
        '≅' => "\\cong",
        '≡' => "\\equiv",
        '≤' => "\\leq",
        '≥' => "\\geq",
        '≠' => "\\neq",
        '≪' => "\\ll",
        '≫' => "\\gg",
        '↔' => "\\leftrightarrow",
        '⇒' => "\\Rightarrow",
        _ => {
            let (name, _) = signs().find(|(_, sign)| *sign == c)?;
            return Some(format!("\\{name}"));
        }
    };
    Some(sign.into())
}

/// Raised and lowered characters.
fn script(c: char) -> Option<String> {
    let of = |all: &str, mark: char| {
        let place = all.chars().position(|one| one == c)?;
        let sign = "0123456789+-=()ni".chars().nth(place)?;
        Some(format!("{mark}{sign}"))
    };
    of("⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻⁼⁽⁾ⁿⁱ", '^').or_else(|| of("₀₁₂₃₄₅₆₇₈₉₊₋₌₍₎", '_'))
}

/// As text.
fn letters(c: char) -> Option<&'static str> {
    Some(match c {
        '\\' => "\\textbackslash{}",
        '^' => "\\textasciicircum{}",
        '~' => "\\textasciitilde{}",
        '`' => "\\textasciigrave{}",
        '"' => "''",
        '’' => "'",
        // Capitals that Greek shares with Latin.
        'Α' => "A",
        'Β' => "B",
        'Ε' => "E",
        'Ζ' => "Z",
        'Η' => "H",
        'Ι' => "I",
        'Κ' => "K",
        'Μ' => "M",
        'Ν' => "N",
        'Ο' => "O",
        'Ρ' => "P",
        'Τ' => "T",
        'Χ' => "X",
        // Letters that LaTeX lacks, from others.
        'Ħ' => "\\ooalign{\\hfil-\\hfil\\crcr H\\crcr}",
        'Ŧ' => "\\ooalign{\\hfil-\\hfil\\crcr T\\crcr}",
        'ŧ' => "\\ooalign{\\hfil-\\hfil\\crcr t\\crcr}",
        'ĸ' => "\\textsc{k}",
        'Ŀ' => "L\\textperiodcentered{}",
        'ŀ' => "l\\textperiodcentered{}",
        'ŉ' => "'n",
        'ſ' => "s",
        '\u{2009}' | '\u{202f}' => "\\,",
        '\u{200a}' => "\\kern0.06em ",
        _ => return None,
    })
}
