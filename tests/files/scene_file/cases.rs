//! One row per error: the change to the valid scene, and the position and text of the message.

use crate::scene_file::{Folder, VALID, problem};

pub struct Case {
    pub from: &'static str,
    pub to: &'static str,
    pub place: &'static str,
    /// The text that the label points at.
    pub span: &'static str,
    pub what: &'static str,
    pub help: &'static str,
}

/// Rows of: text to replace → its replacement; place, text at the label; what is wrong, help.
macro_rules! cases {
    ($name:ident: $($from:tt => $to:tt at $place:tt $span:tt: $what:tt, $help:tt;)*) => {
        const $name: &[crate::scene_file::cases::Case] = &[$(crate::scene_file::cases::Case {
            from: $from,
            to: $to,
            place: $place,
            span: $span,
            what: $what,
            help: $help,
        }),*];
    };
}

/// Each row changes the valid scene, and is refused as it says.
pub fn check(cases: &[Case]) {
    let folder = Folder::with_files();
    for case in cases {
        let text = VALID.replacen(case.from, case.to, 1);
        assert_ne!(
            text, VALID,
            "nothing changed by {} → {}",
            case.from, case.to
        );
        let result = folder.parse(&text);
        if let Err(error) = &result {
            assert!(error.report(false).contains(" --> scene.toml:"), "{error}");
        }
        let refusal = problem(result);
        let named = format!("{} → {}: {refusal} ({})", case.from, case.to, refusal.help);
        assert_eq!(refusal.place, case.place, "{named}");
        assert!(refusal.what.contains(case.what), "{named}");
        assert!(refusal.help.contains(case.help), "{named}");
        let snippet = refusal.snippet.as_ref().expect("a label");
        let at = &text[snippet.labels[0].0.clone()];
        assert!(at.starts_with(case.span), "{named}: points at {at}");
    }
}
