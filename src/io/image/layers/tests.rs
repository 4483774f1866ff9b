use super::*;

fn channel(name: &str, n: usize) -> Channel {
    Channel {
        name: name.into(),
        samples: Samples::F32(vec![0.0; n]),
    }
}

fn message(result: Result<Layers>) -> String {
    result.unwrap_err().to_string()
}

#[test]
fn a_channel_of_another_length_is_refused_by_name() {
    let layers = Layers::new(2, 2, vec![channel("a", 4), channel("b", 3)], vec![]);
    assert_eq!(message(layers), "image, b: 3 samples for 4 pixels");
}

#[test]
fn names_and_keys_are_unique() {
    let layers = Layers::new(1, 1, vec![channel("a", 1), channel("a", 1)], vec![]);
    assert!(message(layers).contains("two channels"));
    let entry = ("k".to_string(), "v".to_string());
    let layers = Layers::new(1, 1, vec![], vec![entry.clone(), entry]);
    assert!(message(layers).contains("two metadata entries"));
}

#[test]
fn empty_and_unaddressable_sizes_are_refused() {
    assert!(message(Layers::new(0, 5, vec![], vec![])).contains("0 × 5"));
    assert!(Layers::new(u32::MAX, u32::MAX, vec![], vec![]).is_err());
}

#[test]
fn names_that_no_file_can_hold_are_refused() {
    for name in ["", "a\0b", "line\nbreak", &"x".repeat(256)] {
        assert!(Layers::new(1, 1, vec![channel(name, 1)], vec![]).is_err());
    }
    for key in ["", "two words", "µ", &"x".repeat(80)] {
        let entry = (key.to_string(), String::new());
        assert!(Layers::new(1, 1, vec![], vec![entry]).is_err(), "{key}");
    }
}

#[test]
fn the_first_of_entries_with_one_key_is_left() {
    let entries = ["a=1", "b=2", "a=3", "c=4", "b=5"].map(|e| e.split_once('=').unwrap());
    let mut entries = entries.map(|(k, v)| (k.into(), v.into())).to_vec();
    keep_first(&mut entries);
    let left: Vec<_> = entries.iter().map(|(k, v)| format!("{k}={v}")).collect();
    assert_eq!(left, ["a=1", "b=2", "c=4"]);
}

#[test]
fn a_single_channel_beside_alpha_and_depth_is_grey() {
    let of = |names: &[&str]| {
        let channels = names.iter().map(|name| channel(name, 1)).collect();
        let layers = Layers::new(1, 1, channels, vec![]).unwrap();
        layers.grey().map(|channel| channel.name.clone())
    };
    assert_eq!(of(&["A", "Y", "Z"]), Some("Y".into()));
    assert_eq!(of(&["Y", "V"]), None);
    assert_eq!(of(&["A"]), None);
}

#[test]
fn radiance_needs_its_three_channels() {
    let names = ["radiance.R", "radiance.G", "radiance.B"];
    let channels: Vec<_> = names.iter().map(|name| channel(name, 1)).collect();
    let two = Layers::new(1, 1, channels[..2].to_vec(), vec![]).unwrap();
    assert_eq!(two.radiance(), None);
    let three = Layers::new(1, 1, channels, vec![]).unwrap();
    assert_eq!(three.radiance(), Some(vec![[0.0; 3]]));
}
