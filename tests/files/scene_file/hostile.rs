//! Files that are broken, or meant to break the reader.

use nullray::Error;
use nullray::scene::{Overrides, load};

use crate::common::skipped::skipped;
use crate::scene_file::{Folder, VALID, problem};

#[test]
fn no_change_of_a_byte_makes_the_reader_panic() {
    let folder = Folder::with_files();
    let mut refused = 0;
    for at in 0..VALID.len() {
        for flip in [0x01, 0x02, 0x04, 0x08, 0x10, 0x20, 0x40] {
            let mut bytes = VALID.as_bytes().to_vec();
            bytes[at] ^= flip;
            let text = String::from_utf8(bytes).unwrap();
            refused += usize::from(folder.parse(&text).is_err());
        }
    }
    assert!(refused > VALID.len());
}

#[test]
fn no_truncation_makes_the_reader_or_its_report_panic() {
    let folder = Folder::with_files();
    for end in 0..VALID.len() {
        if let Err(error) = folder.parse(&VALID[..end]) {
            assert!(error.report(false).contains(" --> scene.toml:"), "{end}");
        }
    }
}

#[test]
fn nesting_and_repetition_end_soon() {
    let folder = Folder::with_files();
    let object = "[[object]]\nshape.sphere.radius = 1\n";
    let camera = "[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\n";
    let source = "[[source]]\nmaterials = ['m']\npulse = { position = [0, 0, 0], sigma = '1 m' }\n";
    // Texts of so many parts of the longest.
    let texts = |parts: usize| {
        let many = |count: usize| count / PARTS * parts;
        [
            format!("a = {}", "[".repeat(many(1 << 20))),
            format!("a = {}", "{a = ".repeat(many(1 << 17))),
            format!("{}a = 1", "a.".repeat(many(1 << 18))),
            format!("[{}a]", "a.".repeat(many(1 << 18))),
            format!("{camera}{}", "[[source]]\n".repeat(many(1 << 16))),
            format!("{camera}hfov = \"{}\"", "9".repeat(many(1 << 20))),
            format!("{camera}{} = 1", "k".repeat(many(1 << 20))),
            format!(
                "{camera}{}{}",
                object.repeat(many(20_000)),
                source.repeat(many(20_000))
            ),
            (0..many(50_000)).map(|i| format!("k{i} = 1\n")).collect(),
        ]
    };
    for (short, long) in texts(1).iter().zip(&texts(PARTS)) {
        let seconds = |text: &str| {
            let before = busy();
            let error = folder.parse(text).unwrap_err();
            assert!(error.to_string().len() < 2000);
            Some(busy()? - before?)
        };
        let Some((short, long)) = seconds(short).zip(seconds(long)) else {
            skipped("this system does not tell the time for which a thread was busy");
            continue;
        };
        // Work in proportion to the length takes 8 times as long, its square 64 times; a clock that goes by ticks counts at most some of them.
        assert!(long < 20.0 * short + 0.2, "{short} s, {long} s");
    }
}

/// How many times as long as others texts are.
const PARTS: usize = 8;

/// The seconds for which this thread was busy, whatever else the machine did.
fn busy() -> Option<f64> {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    Some(1e-9 * told.split(' ').next()?.parse::<f64>().ok()?)
}

#[test]
fn surfaces_are_not_multiplied_beyond_bounds() {
    let objects = "[[object]]\nshape.sphere.radius = 1\n".repeat(3000);
    let materials: String = (0..3000).map(|i| format!("'m{i}', ")).collect();
    let text = format!(
        "[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\n{objects}[[source]]\nmaterials = [{materials}]\n\
         pulse = {{ position = [0, 0, 0], sigma = '1 m' }}\n"
    );
    let refusal = problem(Folder::with_files().parse(&text));
    assert!(
        refusal.what.contains("too many surfaces"),
        "{}",
        refusal.what
    );
}

#[test]
fn as_many_pulses_as_lights_are_the_most() {
    let pulses = "[[source]]\npulse = { position = [0, 0, 0], sigma = '1 m' }\n".repeat(10_001);
    let text = format!(
        "[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\n[[object]]\nshape.sphere.radius = 1\n{pulses}"
    );
    let refusal = problem(Folder::with_files().parse(&text));
    assert_eq!(refusal.what, "10001 pulses are too many");
    assert_eq!(refusal.help, "give at most 10000");
}

#[test]
fn a_file_that_is_too_long_is_refused_unread() {
    let folder = Folder::with_files();
    let path = folder.path().join("long.toml");
    std::fs::write(&path, vec![b'#'; (4 << 20) + 1]).unwrap();
    let refusal = problem(load(&path, &Overrides::default()));
    assert!(refusal.what.contains("at most 4 MiB"), "{}", refusal.what);
}

#[test]
fn a_file_that_is_not_text_is_refused_with_the_place() {
    let folder = Folder::with_files();
    let path = folder.path().join("binary.toml");
    std::fs::write(&path, b"a = 1\n\xff\xfe").unwrap();
    let refusal = problem(load(&path, &Overrides::default()));
    assert_eq!(refusal.place, "byte 6");
}

#[test]
fn a_file_that_is_not_there_is_an_io_error() {
    let folder = Folder::with_files();
    let result = load(&folder.path().join("none.toml"), &Overrides::default());
    assert!(matches!(result, Err(Error::Io { .. })));
}

#[test]
fn control_characters_do_not_reach_the_message() {
    let text = "[camera]\n\"\\u001b[31mred\" = 1\n";
    let refusal = problem(Folder::with_files().parse(text));
    assert!(!refusal.to_string().contains('\u{1b}'));
    assert!(!refusal.help.contains('\u{1b}'));
}
