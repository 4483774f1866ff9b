//! Infrared and ultraviolet channels beside the visible ones.

use nullray::io::image::exr;

use super::Folder;
use super::exposure::entry;
use super::refused::refused;

/// A wall that shows a steady picture of 9 × 8 pixels and these channels per pixel, all 0.5.
fn channels_scene(folder: &Folder, count: usize, keys: &str) {
    let header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': (9, 8, {count}), }}");
    let mut bytes = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
    bytes.extend(format!("{header:<117}\n").bytes());
    bytes.extend((0..9 * 8 * count).flat_map(|_| 0.5f32.to_le_bytes()));
    std::fs::write(folder.path("picture.npy"), bytes).unwrap();
    let scene = format!(
        "[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\nsize = [8, 6]\n\
         velocity = {{ beta = 0.6, direction = [0, 0, -1] }}\n\
         [[object]]\nname = \"wall\"\nshape = {{ box = {{ size = [9, 9, 1] }} }}\n\
         [[source]]\n[source.cube]\nfile = \"picture.npy\"\naxes = \"H W C\"\n{keys}\n"
    );
    folder.write("channels.toml", scene);
}

const FIVE: &str = "channels = [\"R\", \"G\", \"B\", \"IR\", \"UV\"]";
const RGB: &str = "[radiance]\nquantity = \"rgb\"";

#[test]
fn channels_of_infrared_and_ultraviolet_are_named_by_info_plan_and_metadata() {
    let folder = Folder::empty();
    channels_scene(&folder, 5, &format!("{FIVE}\n{RGB}"));
    let info = folder.ok(&["info", "channels.toml"]);
    assert!(
        info.contains("1 time bins, channels R, G, B, IR, UV"),
        "{info}"
    );
    assert!(
        info.contains("continued by infrared and ultraviolet channels"),
        "{info}"
    );
    let data: serde_json::Value =
        serde_json::from_str(&folder.ok(&["info", "channels.toml", "--json"])).unwrap();
    assert_eq!(data["sources"][0]["cube"]["channels"][3], "IR");
    let plan = folder.ok(&["plan", "channels.toml"]);
    assert!(
        plan.contains("1 time bins, channels R, G, B, IR, UV"),
        "{plan}"
    );
    assert!(
        plan.contains("UV is its radiance from 100 to 360 nm; it is dark outside these"),
        "{plan}"
    );
    folder.ok(&["render", "channels.toml", "-o", "a.png"]);
    assert_eq!(
        entry(&folder, "a.png", "radiance_continuation").unwrap(),
        "companions"
    );
    assert!(entry(&folder, "a.png", "infrared_channel_m").is_some());
    // At half the wavelengths the infrared is seen alone, which the light that left visible has left.
    let dark = ["--set", "radiance.continuation=dark", "-o", "b.exr"];
    folder.ok(&[&["render", "channels.toml"][..], &dark].concat());
    folder.ok(&["render", "channels.toml", "-o", "c.exr"]);
    let brightness = |name: &str| {
        let layers = exr::read(&folder.path(name), &Default::default()).unwrap();
        layers
            .radiance()
            .unwrap()
            .iter()
            .map(|rgb| rgb[1])
            .sum::<f64>()
    };
    assert!(brightness("c.exr") > 3.0 * brightness("b.exr"));
}

/// A scene whose pictures have most keys of metadata.
const EVERYTHING: &str = r#"
[camera]
eye = [0, 1, 4]
look_at = [0, 0.5, 0]
hfov = "60 deg"
size = [8, 6]
frame_interval = "1 m"
[camera.motion]
circle = { centre = [0, 1, 0], axis = [0, 1, 0], rate = "0.01 rad/m" }
[camera.sensor]
focal_length = "36 mm"
[camera.shutter]
duration = "1 cm"
integration = "means"
[[object]]
shape = { plane = { size = [8, 8] } }
[[light]]
position = [0, 5, 0]
[radiance]
quantity = "rgb"
[render]
bounces = 1
spectra = "sampled"
[display]
false_colour = "1 um"
"#;

#[test]
fn the_guide_explains_every_key_of_metadata() {
    let guide = include_str!("../../../src/light/guide.md");
    let folder = Folder::empty();
    folder.write("scene.toml", EVERYTHING);
    let options = ["--spp", "4", "--passes", "2", "--aovs", "standard_error"];
    folder.ok(&[&["render", "scene.toml", "-o", "a.exr"][..], &options].concat());
    channels_scene(&folder, 5, &format!("{FIVE}\n{RGB}"));
    folder.ok(&["render", "channels.toml", "-o", "b.png"]);
    let mut keys = Vec::new();
    for name in ["a.exr", "b.png"] {
        let told: serde_json::Value =
            serde_json::from_str(&folder.ok(&["info", name, "--json"])).unwrap();
        keys.extend(told["metadata"].as_object().unwrap().keys().cloned());
    }
    assert!(keys.len() > 50, "{keys:?}");
    let circle = "camera_circle";
    for key in keys {
        let short = key.replace(circle, "");
        assert!(
            guide.contains(&format!("`{key}`")) || guide.contains(&format!("`{short}`")),
            "{key}"
        );
    }
}

#[test]
fn channels_that_cannot_be_are_refused_in_their_place() {
    let folder = Folder::empty();
    let four = "channels = [\"R\", \"G\", \"B\", \"IR\"]";
    for (count, keys, said) in [
        (
            5,
            RGB.into(),
            &["means 5 channels", "`channels` names them"][..],
        ),
        (
            4,
            format!("{FIVE}\n{RGB}"),
            &["4 channels, and `channels` names 5: R, G, B, IR, UV"],
        ),
        (
            5,
            format!("{four}\n{RGB}"),
            &["5 channels, and `channels` names 4"],
        ),
        (
            3,
            format!("{four}\n{RGB}"),
            &["3 channels, and `channels` names 4"],
        ),
        (
            5,
            FIVE.into(),
            &[
                "IR and UV shift into view if colours are spectra",
                "energy over the whole spectrum",
            ],
        ),
        (
            4,
            format!("{four}\n[radiance]\nquantity = \"line\"\nwavelength = \"532 nm\""),
            &["IR shift"],
        ),
        (
            5,
            format!("channels = [\"R\", \"G\", \"B\", \"IR\", \"IR\"]\n{RGB}"),
            &["IR is named twice"],
        ),
        (
            5,
            format!("channels = [\"R\", \"G\", \"UV\", \"IR\", \"Y\"]\n{RGB}"),
            &["\"Y\" is not the name"],
        ),
        (5, format!("channels = []\n{RGB}"), &["no channel R"]),
        (5, format!("channels = 5\n{RGB}"), &["channels"]),
    ] {
        channels_scene(&folder, count, &keys);
        refused(&folder, &["render", "channels.toml"], said);
    }
    // Channels that the array has, fewer than five.
    channels_scene(&folder, 4, &format!("{four}\n{RGB}"));
    folder.ok(&["render", "channels.toml", "-o", "four.png"]);
    // Neither a colour's own spectrum nor another picture has such channels.
    channels_scene(&folder, 3, RGB);
    let spectrum = "object.wall.spectrum={ rgb = [1, 1, 1], continuation = \"companions\" }";
    refused(
        &folder,
        &["render", "channels.toml", "--set", spectrum],
        &["only the channels of cubes have companions"],
    );
    // Captures of one surface that would be blended.
    let capture =
        "[source.cube.capture]\neye = [0, 0, 4]\nlook_at = [0, 0, 0]\nhfov = \"90 deg\"\n";
    channels_scene(&folder, 5, &format!("{FIVE}\n{capture}"));
    let one = std::fs::read_to_string(folder.path("channels.toml")).unwrap();
    let (_, source) = one.split_once("[[source]]").unwrap();
    let other = source
        .replace(FIVE, "channels = [\"B\", \"G\", \"R\"]")
        .replace("picture.npy", "three.npy");
    channels_scene(&folder, 3, "");
    std::fs::rename(folder.path("picture.npy"), folder.path("three.npy")).unwrap();
    channels_scene(&folder, 5, "");
    folder.write("channels.toml", format!("{one}[[source]]{other}{RGB}\n"));
    refused(
        &folder,
        &["render", "channels.toml"],
        &[
            "different infrared and ultraviolet channels",
            "continuation = \"dark\"",
        ],
    );
    let dark = [
        "render",
        "channels.toml",
        "--set",
        "radiance.continuation=dark",
        "-o",
        "d.png",
    ];
    folder.ok(&dark);
}
