//! Films decode to the pictures that they contain, whatever made them.

use std::io::Cursor;

use super::Folder;
use super::frames::{FOUR, folder, sequence};
use super::refused::refused;

/// A picture: columns, rows, and three bytes for each pixel.
type Rgb = (u32, u32, Vec<u8>);

/// All pictures of an animated PNG.
fn apng(file: &[u8]) -> Vec<Rgb> {
    let mut reader = png::Decoder::new(Cursor::new(file)).read_info().unwrap();
    let count = reader.info().animation_control.unwrap().num_frames;
    let (width, height) = reader.info().size();
    let picture = |_| {
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut bytes).unwrap();
        let samples = bytes.len() / (width * height) as usize;
        let rgb = bytes.chunks_exact(samples).flat_map(|pixel| &pixel[..3]);
        (width, height, rgb.copied().collect())
    };
    (0..count).map(picture).collect()
}

/// The picture of a PNG.
fn picture(folder: &Folder, name: &str) -> Rgb {
    let file = folder.read(name);
    let mut reader = png::Decoder::new(Cursor::new(file)).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let frame = reader.next_frame(&mut bytes).unwrap();
    (frame.width, frame.height, bytes)
}

/// All pictures of raw video, by the inverse of BT.709: with y, b, r the components from 0 to 1 and from −½ to ½,
/// R = y + 1.5748 r, B = y + 1.8556 b, and G from y = 0.2126 R + 0.7152 G + 0.0722 B.
fn y4m(file: &[u8]) -> Vec<Rgb> {
    let end = file.iter().position(|byte| *byte == b'\n').unwrap();
    let header = std::str::from_utf8(&file[..end]).unwrap();
    let words: Vec<_> = header.split(' ').collect();
    assert_eq!((words[0], words[6]), ("YUV4MPEG2", "C444"), "{header}");
    let [width, height] = [1, 2].map(|k| words[k][1..].parse::<u32>().unwrap());
    let pixels = (width * height) as usize;
    let frames = file[end + 1..].chunks_exact(6 + 3 * pixels);
    assert!(frames.remainder().is_empty());
    let decode = |frame: &[u8]| {
        let codes = frame.strip_prefix(b"FRAME\n").unwrap();
        let colour = |k: usize| {
            let y = (f64::from(codes[k]) - 16.0) / 219.0;
            let b = (f64::from(codes[pixels + k]) - 128.0) / 224.0;
            let r = (f64::from(codes[2 * pixels + k]) - 128.0) / 224.0;
            let (red, blue) = (y + 1.5748 * r, y + 1.8556 * b);
            let green = (y - 0.2126 * red - 0.0722 * blue) / 0.7152;
            [red, green, blue].map(|c| (255.0 * c).round().clamp(0.0, 255.0) as u8)
        };
        (width, height, (0..pixels).flat_map(colour).collect())
    };
    frames.map(decode).collect()
}

/// Equal but for so many codes.
fn assert_near(a: &Rgb, b: &Rgb, codes: u8) {
    assert_eq!((a.0, a.1), (b.0, b.1));
    let worst = a.2.iter().zip(&b.2).map(|(a, b)| a.abs_diff(*b)).max();
    assert!(worst.unwrap() <= codes, "{worst:?}");
}

#[test]
fn a_sequence_as_a_film_is_its_pictures() {
    let folder = folder();
    let outputs = [
        "-o",
        "a.apng",
        "-o",
        "a.y4m",
        "-o",
        "f-#.png",
        "--play-fps",
        "12.5",
    ];
    folder.ok(&sequence(&[&FOUR[..], &outputs].concat()));
    let (exact, raw) = (apng(&folder.read("a.apng")), y4m(&folder.read("a.y4m")));
    assert_eq!((exact.len(), raw.len()), (4, 4));
    for k in 0..4 {
        let still = picture(&folder, &format!("f-{k}.png"));
        assert_near(&exact[k], &still, 0);
        // The bound of two codes is derived in io/image/film.rs.
        assert_near(&raw[k], &still, 2);
    }
    assert!(
        folder
            .read("a.y4m")
            .starts_with(b"YUV4MPEG2 W12 H9 F1000:80 ")
    );
    // Of a part of a sequence, and to a pipe, without numbered pictures that stay.
    let part = ["--frames", "2..4", "--interval", "10 cm", "-o", "-"];
    let run = folder.command(&sequence(&part)).output().unwrap();
    assert!(run.status.success() && run.stderr.is_empty());
    assert_eq!(y4m(&run.stdout), raw[2..]);
    assert_eq!(
        folder.names(),
        [
            "a.apng",
            "a.y4m",
            "f-0.png",
            "f-1.png",
            "f-2.png",
            "f-3.png",
            "scene.toml"
        ]
    );
}

#[test]
fn a_film_of_pictures_of_16_bits_says_that_it_has_8() {
    let folder = folder();
    let deep = ["--set", "display.bits=16", "-o", "a.apng"];
    let said = folder.ok(&sequence(&[&FOUR[..], &deep].concat()));
    assert!(said.contains("a.apng has 8 bits per sample"), "{said}");
    let said = folder.ok(&sequence(&[&FOUR[..], &["-o", "a.apng"]].concat()));
    assert!(!said.contains("bits"), "{said}");
}

#[test]
fn the_pictures_of_a_fly_by_are_those_of_a_camera_that_passes() {
    let folder = Folder::new();
    let film = "film scene.toml --flyby 0.6 --direction x --distance";
    let film: Vec<_> = film
        .split(' ')
        .chain(["3 m", "--pictures", "5", "--white", "0.5", "--no-captions"])
        .collect();
    folder.ok(&film);
    let film = apng(&folder.read("scene.apng"));
    assert_eq!(film.len(), 5);
    // What it looks at is √(4² + 0.5²) m away, and ahead γβ = 0.75 times as far on. Picture 3 is 0.75 m on, 0.75/0.6 = 1.25 m of time
    // later.
    let middle = 0.75 * 16.25_f64.sqrt();
    for (k, x) in [(2, middle), (3, middle + 0.75)] {
        let eye = format!("camera.eye=[{x:?},1,4]");
        let time = format!("camera.clock_zero={:?} m", x / 0.6);
        // The same forward axis as that of the scene.
        let mut arguments = vec![
            "render",
            "scene.toml",
            "--white",
            "0.5",
            "-o",
            "still.png",
            "--set",
            &eye,
            "--set",
            &time,
        ];
        let look_at = format!("camera.look_at=[{x:?},0.5,0]");
        arguments.extend([
            "--set",
            &look_at,
            "--set",
            "camera.velocity={beta=[0.6,0,0]}",
        ]);
        folder.ok(&arguments);
        assert_near(&film[k], &picture(&folder, "still.png"), 1);
    }
    assert_eq!(folder.names(), ["scene.apng", "scene.toml", "still.png"]);
}

#[test]
fn an_acceleration_from_rest_ends_with_the_speed_after_the_distance() {
    let folder = Folder::new();
    let film = "film scene.toml --accelerate 0.6 --direction -z --pictures 4 --white 0.5 --no-captions -o a.apng --distance";
    let film: Vec<_> = film.split(' ').chain(["1 m"]).collect();
    folder.ok(&film);
    let film = apng(&folder.read("a.apng"));
    // a = (γ − 1)/s = 0.25/m, so that 0.6 is reached after γβ/a = 3 m of time.
    let changes = [
        "camera.eye=[0,1,3]",
        "camera.look_at=[0,0.5,-1]",
        "camera.clock_zero=3 m",
        "camera.velocity={beta=[0,0,-0.6]}",
    ];
    let rest = ["camera.velocity={beta=[0,0,0]}"];
    for (picture_of, changes) in [(&film[0], &rest[..]), (&film[3], &changes[..])] {
        let mut arguments = vec!["render", "scene.toml", "--white", "0.5", "-o", "still.png"];
        changes
            .iter()
            .for_each(|change| arguments.extend(["--set", change]));
        folder.ok(&arguments);
        assert_near(picture_of, &picture(&folder, "still.png"), 1);
    }
}

#[test]
fn folders_of_films_that_were_killed_days_ago_go_with_the_next_film() {
    let folder = Folder::new();
    let days_ago = std::time::SystemTime::now() - std::time::Duration::from_secs(3 * 86_400);
    let aged = |name: &str| {
        let file = std::fs::File::open(folder.path(name)).unwrap();
        file.set_modified(days_ago).unwrap();
    };
    let pictures = |name: &str, other: &str| {
        std::fs::create_dir(folder.path(name)).unwrap();
        for picture in ["film-000000.png", other] {
            folder.write(&format!("{name}/{picture}"), b"x");
            aged(&format!("{name}/{picture}"));
        }
    };
    pictures("left.apng.frames", "film-000001.png");
    pictures("young.apng.frames", "film-000001.png");
    pictures("own.apng.frames", "notes.txt");
    aged("left.apng.frames");
    aged("own.apng.frames");
    let film = "film scene.toml --speeds 0.5 --pictures 2 -q -o a.apng";
    folder.ok(&film.split(' ').collect::<Vec<_>>());
    let expected = [
        "a.apng",
        "own.apng.frames",
        "scene.toml",
        "young.apng.frames",
    ];
    assert_eq!(folder.names(), expected);
}

#[test]
fn a_film_can_show_rest_or_a_diagram_beside_its_pictures() {
    let folder = Folder::new();
    folder.ok(&"film scene.toml --speeds 0.9 --pictures 3 -o one.apng"
        .split(' ')
        .collect::<Vec<_>>());
    let one = apng(&folder.read("one.apng"));
    for what in ["rest", "diagram"] {
        let words = format!(
            "film scene.toml --speeds 0.9 --pictures 3 -o two.apng --beside {what} --caption here"
        );
        folder.ok(&words.split(' ').collect::<Vec<_>>());
        let two = apng(&folder.read("two.apng"));
        assert_eq!(two.len(), 3);
        assert!(two[0].0 > one[0].0 + 32, "{what}");
        assert!(two[0] != two[2], "{what}");
    }
    assert_eq!(folder.names(), ["one.apng", "scene.toml", "two.apng"]);
}

#[test]
fn a_diagram_that_cannot_stand_beside_the_pictures_is_refused_before_they_are_rendered() {
    let folder = Folder::new();
    for motion in ["--flyby", "--accelerate"] {
        let film = ["film", "scene.toml", motion, "0.5", "--beside", "diagram"];
        let run = folder.run(&[&film[..], &["--pictures", "2", "-o", "a.apng"]].concat());
        assert_eq!(run.code, 2, "{}", run.stderr);
        assert!(run.message().contains("--speeds 0.9"), "{}", run.stderr);
        assert_eq!(run.stdout, "");
        assert_eq!(folder.names(), ["scene.toml"], "{motion}");
    }
}

#[test]
fn captions_in_characters_that_the_font_lacks_are_refused_before_pictures_are_rendered() {
    let folder = Folder::new();
    let film = "film scene.toml --flyby 0.5 --pictures 2 -o a.apng --quiet";
    let film: Vec<&str> = film.split(' ').collect();
    refused(
        &folder,
        &[&film[..], &["--caption", "日本"]].concat(),
        &["command line, --caption", "'日'"],
    );
    let own = ["--set", "display.caption=\"a\\tb\""];
    let parts = ["scene.toml, display.caption", "has no character"];
    refused(&folder, &[&film[..], &own].concat(), &parts);
    let render = ["render", "scene.toml", "-o", "a.png"];
    refused(&folder, &[&render[..], &own].concat(), &parts);
}

#[test]
fn light_in_flight_is_found_where_no_times_are_given() {
    let folder = Folder::new();
    let film = "film scene.toml --light --pictures 5 --no-captions -o a.apng --set source.lamp.pulse.sigma=\"0.2 m\"";
    let film: Vec<_> = film.splitn(10, ' ').collect();
    folder.ok(&film);
    let pictures = apng(&folder.read("a.apng"));
    // From before the pulse to after it, with light between.
    let lit = |rgb: &Rgb| rgb.2.iter().any(|code| *code > 20);
    assert!(pictures[1..4].iter().any(lit));
    assert!(pictures.iter().any(|picture| *picture != pictures[0]));
}

#[test]
fn diagrams_are_the_same_as_raw_video_and_as_animated_png() {
    let folder = Folder::new();
    let words = "diagram scene.toml --boost-to camera --frames 0..3 --scale 0.5 -o a.apng -o a.y4m";
    folder.ok(&words.split(' ').collect::<Vec<_>>());
    let (exact, raw) = (apng(&folder.read("a.apng")), y4m(&folder.read("a.y4m")));
    assert_eq!(exact.len(), 3);
    for (a, (width, height, codes)) in exact.iter().zip(&raw) {
        // Raw video has an even number of rows.
        assert_eq!(*height, a.1.next_multiple_of(2));
        let shown = codes[..a.2.len()].to_vec();
        assert_near(a, &(*width, a.1, shown), 2);
    }
    let piped = words.replace("-o a.apng -o a.y4m", "-o -");
    let run = folder
        .command(&piped.split(' ').collect::<Vec<_>>())
        .output()
        .unwrap();
    assert_eq!(y4m(&run.stdout), raw);
}

/// A wall of radiance 0.5 that fills the picture of a camera at rest in front of it. At the speed β towards it, it is D⁴ times as bright,
/// with D² = (1 + β)/(1 − β).
pub(super) const WALL: &str = "[camera]\neye = [0, 0, 30]\nlook_at = [0, 0, 0]\nsize = [24, 16]\nhfov = \"2 deg\"\n\
     [[object]]\ncolour = [0.5, 0.5, 0.5]\nshape = { plane = { size = [90, 90] } }\n\
     transform = { rotate = { axis = [1, 0, 0], angle = \"90 deg\" } }\n";

#[test]
fn one_place_at_many_speeds_has_one_exposure() {
    let folder = Folder::empty();
    folder.write("wall.toml", WALL);
    let film = |more: &str| {
        let words = format!("film wall.toml --no-captions --pictures 3 -o a.apng --speeds {more}");
        let said = folder.ok(&words.split(' ').collect::<Vec<_>>());
        let pictures = apng(&folder.read("a.apng"));
        let codes: Vec<u8> = pictures.iter().map(|picture| picture.2[0]).collect();
        (said, codes, pictures)
    };
    let near = |codes: &[u8], expected: [u8; 3]| {
        let mut both = codes.iter().zip(expected);
        both.all(|(a, b)| a.abs_diff(b) <= 1)
    };
    let radiance = |said: &str, before: &str| {
        let all = said
            .lines()
            .find(|line| line.starts_with("one exposure for all frames"));
        let number = all.and_then(|line| line.split(before).nth(1)).expect(said);
        number.split(' ').next().unwrap().parse::<f64>().unwrap()
    };
    // D⁴ = 1, 4 and 16: white is 8, of which the others are 1/16 and 1/4.
    let (said, codes, _) = film("0.6");
    let white = radiance(&said, "white is radiance ");
    assert!((white / 8.0 - 1.0).abs() < 0.01, "{said}");
    assert!(near(&codes, [71, 137, 255]), "{codes:?}");
    // D⁴ = 1, 19 and 361, over 30: black is a hundredth of 0.5, white 180.5, and ln 100/ln 36100 = 0.4388.
    let (said, codes, _) = film("0.9");
    let black = radiance(&said, "by the logarithm of radiance, from ");
    assert!((black / 0.005 - 1.0).abs() < 0.01, "{said}");
    assert!(near(&codes, [112, 183, 255]), "{codes:?}");
    // A camera at rest beside it is shown as it is in the first picture.
    let (_, _, pictures) = film("0.9 --beside rest");
    let rest = pictures[2].2.iter().filter(|code| code.abs_diff(112) <= 1);
    assert!(rest.count() >= 3 * 24 * 16);
    // Each its own, on request.
    let (said, codes, _) = film("0.9 --own-exposure");
    assert!(
        !said.contains("one exposure") && near(&codes, [255; 3]),
        "{said}"
    );
}

#[test]
fn a_film_is_exposed_for_its_middle_and_not_for_the_scene_s_own_camera() {
    let folder = Folder::new();
    // A camera that falls towards the wall: at the ends of the film D⁴ is 1 and 1521, and at most 1521^(5/8) = 97 in its middle third.
    folder.write("wall.toml", WALL.to_owned() + "[display]\nwhite = 1e5\n");
    let film = "film wall.toml --accelerate 0.95 --pictures 9 --no-captions -o a.apng";
    let said = folder.ok(&film.split(' ').collect::<Vec<_>>());
    let white = said.split("white is radiance ").nth(1).unwrap();
    let white: f64 = white.lines().next().unwrap().parse().unwrap();
    let expected = 0.5 * 1521f64.powf(5.0 / 8.0);
    assert!((white / expected - 1.0).abs() < 0.01, "{white}, {expected}");
    // 1/97 of white is the code 25, and the middle is as bright as 1521^(1/8) = 2.5 below it: 170.
    let codes: Vec<u8> = apng(&folder.read("a.apng"))
        .iter()
        .map(|p| p.2[0])
        .collect();
    assert!(
        codes[0].abs_diff(25) <= 2 && codes[4].abs_diff(170) <= 3,
        "{codes:?}"
    );
    assert_eq!(codes[5..], [255; 4]);
    // What the command line says holds.
    for say in ["--white 2", "--set display.white=2"] {
        let words = format!("{film} {say}");
        let said = folder.ok(&words.split(' ').collect::<Vec<_>>());
        assert!(!said.contains("white is radiance 48"), "{said}");
        let code = apng(&folder.read("a.apng"))[0].2[0];
        assert_eq!(code, 137, "{say}");
    }
}

#[test]
fn a_reader_that_has_read_enough_of_a_film_ends_it_without_an_error() {
    use std::io::Read;
    use std::process::Stdio;
    let folder = Folder::new();
    let twins = super::repository("scenes/diagrams/twin-paradox.toml");
    let film = "film scene.toml --flyby 0.5 --pictures 60 --spp 1 -o -";
    let film: Vec<_> = film.split(' ').collect();
    let diagram = ["diagram", &twins, "--frames", "0..3", "-o", "-"];
    for arguments in [&film[..], &diagram] {
        let mut command = folder.command(arguments);
        let mut run = command
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut start = [0; 1000];
        // Dropped when it is read.
        run.stdout.take().unwrap().read_exact(&mut start).unwrap();
        assert!(start.starts_with(b"YUV4MPEG2"));
        let done = run.wait_with_output().unwrap();
        let said = String::from_utf8(done.stderr).unwrap();
        assert_eq!((done.status.code(), said.as_str()), (Some(0), ""));
    }
}

#[test]
fn films_that_cannot_be_made_are_refused() {
    let folder = folder();
    let cases: &[(&str, &[&str])] = &[
        (
            "render scene.toml -o a.apng",
            &["-o a.apng", "frames of a sequence", "nullray film"],
        ),
        (
            "render scene.toml -o a.exr --caption x",
            &["--caption", "-o FILE.png"],
        ),
        ("film scene.toml", &["--flyby", "--light"]),
        ("film --frames 2", &["--pictures 2"]),
        ("film scene.toml --light --frames 0..2", &["--pictures <N>"]),
        ("film scene.toml --flyby 0.5 --light", &["cannot be used"]),
        ("film scene.toml --flyby 1", &["--flyby 1", "below 1"]),
        (
            "film scene.toml --flyby 0.5 --distance 5",
            &["--distance", "a length is a text like \"5 m\""],
        ),
        (
            "film scene.toml --flyby 0.5 --distance -1m",
            &["--distance", "a length above 0"],
        ),
        ("film scene.toml --pictures -1", &["--pictures", "2..="]),
        (
            "page scene.toml -o p --max-size -1",
            &["--max-size", "0 or above"],
        ),
        (
            "film scene.toml --flyby 0.5 -o a.gif",
            &["-o a.gif", "films as .gif", ".apng", ".y4m", "ffmpeg -i -"],
        ),
        (
            "film scene.toml --flyby 0.5 -o - -o -",
            &["-o -", "two films"],
        ),
        (
            "film scene.toml --flyby 0.5 -o no/a.apng",
            &["-o no/a.apng", "there is no directory"],
        ),
        (
            "film scene.toml --accelerate 0.5 --direction away",
            &[
                "--direction",
                "-x",
                "`render` and `plan` of a model without a scene",
            ],
        ),
        (
            "film scene.toml --light --time 1m",
            &["--light", "--time", "cannot be used"],
        ),
        (
            "film scene.toml --light --beside rest",
            &["--beside rest", "--light"],
        ),
    ];
    for (words, parts) in cases {
        refused(&folder, &words.split(' ').collect::<Vec<_>>(), parts);
    }
}

#[test]
fn scenes_that_name_no_point_to_look_at_are_filmed_as_far_as_what_they_show() {
    let folder = Folder::new();
    let gallery = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/gallery");
    for name in ["clocks", "stars", "street", "trains", "tunnel"] {
        let scene = format!("{gallery}/{name}.toml");
        let film = [
            "film",
            &scene,
            "--flyby",
            "0.5",
            "--pictures",
            "2",
            "--size",
            "24x16",
            "--spp",
            "1",
            "-o",
            "a.apng",
        ];
        folder.ok(&film);
        assert_eq!(apng(&folder.read("a.apng")).len(), 2, "{name}");
    }
    // A wall 3 m away that is named, and the same one that is found: the same pictures. It is as large as the picture.
    let wall = |camera: &str| {
        format!(
            "[camera]\neye = [0, 0, 3]\n{camera}\nsize = [24, 16]\nhfov = \"2 deg\"\n[display]\nwhite = 1\n[[object]]\n\
             shape = {{ plane = {{ size = [9, 9] }} }}\ntransform = {{ rotate = {{ axis = [1, 0, 0], angle = \"90 deg\" }} }}\n"
        )
    };
    folder.write("named.toml", wall("look_at = [0, 0, 0]"));
    folder.write("found.toml", wall("forward = [0, 0, -1]"));
    let films = ["named", "found"].map(|name| {
        let scene = format!("{name}.toml");
        let film = format!("{name}.y4m");
        folder.ok(&[
            "film",
            &scene,
            "--accelerate",
            "0.5",
            "--pictures",
            "3",
            "-o",
            &film,
        ]);
        y4m(&folder.read(&film))
    });
    for (a, b) in films[0].iter().zip(&films[1]) {
        assert_near(a, b, 1);
    }
    // Where nothing is in view the nearest object counts.
    folder.write("away.toml", wall("forward = [0, 0, 1]"));
    folder.ok(&[
        "film",
        "away.toml",
        "--flyby",
        "0.5",
        "--pictures",
        "2",
        "-o",
        "a.apng",
    ]);
}

#[test]
fn a_film_of_a_cube_shows_its_lit_part_and_not_all_of_its_bins() {
    let folder = Folder::empty();
    let scene = "camera = { eye = [0, 2, 4], look_at = [0, 0, 0], hfov = \"50 deg\", size = [16, 12] }\n\
         [[object]]\nname = \"floor\"\nshape = { plane = { size = [4, 4] } }\n";
    let flash =
        "[[light]]\nposition = [0.5, 1.5, 0]\nemission = { gaussian = { sigma = \"30 cm\" } }\n";
    folder.write("lit.toml", scene.to_string() + flash);
    // Light of about 4 m in bins of 400 m.
    let said = folder.ok(&[
        "bake",
        "lit.toml",
        "--bin-width=20 cm",
        "--bins=2000",
        "--texels=8x8",
        "-o=light.npz",
    ]);
    let source = said.split_once("\n\n").unwrap().1;
    folder.write("baked.toml", scene.to_string() + source);
    folder.ok(&[
        "film",
        "baked.toml",
        "--light",
        "--pictures=3",
        "-o=a.y4m",
        "-q",
    ]);
    let pictures = y4m(&folder.read("a.y4m"));
    let (_, _, middle) = &pictures[1];
    assert!(middle.iter().any(|code| *code > 50), "{middle:?}");
}

#[test]
fn a_film_begins_where_the_scenes_own_camera_takes_its_picture() {
    let folder = Folder::empty();
    let scene = |camera: &str| {
        format!(
            "[camera]\nlook_at = [0, 0, 0]\nhfov = \"50 deg\"\nsize = [24, 18]\n{camera}\n[display]\nwhite = 1\nsamples_per_pixel = 1\n\
             [[object]]\nshape = {{ box = {{ size = [1, 1, 1] }} }}\n"
        )
    };
    // 0.6 c for 4 m of its own time, which are 5 m of the world's: to (3, 0, 5).
    let moving =
        "eye = [0, 0, 5]\nforward = [-3, 0, -5]\ntime = \"4 m\"\nvelocity = { beta = [0.6, 0, 0] }";
    let moving = scene(moving).replace("look_at = [0, 0, 0]\n", "");
    let resting = "eye = [3, 0, 5]\nforward = [-3, 0, -5]\nclock_zero = \"5 m\"";
    let resting = scene(resting).replace("look_at = [0, 0, 0]\n", "");
    folder.write("moving.toml", moving);
    folder.write("resting.toml", resting);
    let films = ["moving", "resting"].map(|name| {
        let film = format!("{name}.apng");
        let toml = format!("{name}.toml");
        folder.ok(&[
            "film",
            &toml,
            "--speeds",
            "0.8",
            "--pictures",
            "3",
            "-o",
            &film,
        ]);
        apng(&folder.read(&film))
    });
    assert!(films[0] == films[1]);
}

/// From rest to 10⁻⁸ c within 2 m: the last picture is that of a camera which has gone there, as aberration by 10⁻⁸ is below what is seen.
#[test]
fn a_film_of_the_slowest_acceleration_goes_all_the_way() {
    let folder = Folder::empty();
    folder.write(
        "box.toml",
        "[camera]\neye = [1, 2, 6]\nlook_at = [0, 0, 0]\nsize = [24, 18]\n\
         [[object]]\nshape = { box = { size = [1, 1, 1] } }\ncolour = [0.2, 0.4, 0.8]\n",
    );
    let options = [
        "--direction=-z",
        "--distance",
        "2 m",
        "--pictures",
        "3",
        "--white",
        "1",
        "--no-captions",
        "-o",
        "a.apng",
    ];
    folder.ok(&[&["film", "box.toml", "--accelerate", "1e-8"], &options[..]].concat());
    let frames = apng(&folder.read("a.apng"));
    let turned = "camera.forward=[-1, -2, -6]";
    for (eye, frame) in [("[1, 2, 6]", &frames[0]), ("[1, 2, 4]", &frames[2])] {
        let eye = format!("camera.eye={eye}");
        let scene = "[camera]\nsize = [24, 18]\n[[object]]\nshape = { box = { size = [1, 1, 1] } }\ncolour = [0.2, 0.4, 0.8]\n";
        folder.write("still.toml", scene);
        folder.ok(&[
            "render",
            "still.toml",
            "--set",
            &eye,
            "--set",
            turned,
            "--white",
            "1",
            "-o",
            "a.png",
        ]);
        let still = picture(&folder, "a.png");
        assert!(frame.2.iter().any(|code| *code > 50));
        assert_near(frame, &still, 2);
    }
}

#[test]
fn a_film_goes_to_a_pipe_picture_by_picture_and_ends_with_its_reader() {
    use std::io::Read;
    use std::process::Stdio;

    let folder = folder();
    let arguments = sequence(&["--frames", "0..2000", "--interval", "1 mm", "-o", "-"]);
    let mut command = folder.command(&arguments);
    let pictures = tempfile::tempdir().unwrap();
    command.env("TMPDIR", pictures.path());
    let mut child = command.stdout(Stdio::piped()).spawn().unwrap();
    let mut pipe = child.stdout.take().unwrap();
    let header = "YUV4MPEG2 W12 H9 F24:1 Ip A1:1 C444 XCOLORRANGE=LIMITED\n";
    let mut start = vec![0; header.len() + 6 + 3 * 12 * 9];
    pipe.read_exact(&mut start).unwrap();
    assert!(start.starts_with(header.as_bytes()));
    // Pipes hold some hundreds of them.
    let parts = std::fs::read_dir(pictures.path()).unwrap();
    let made = parts.map(|part| std::fs::read_dir(part.unwrap().path()).unwrap().count());
    let made = made.sum::<usize>();
    assert!(made > 0 && made < 1000, "{made}");
    drop(pipe);
    assert!(child.wait().unwrap().success());
    assert_eq!(pictures.path().read_dir().unwrap().count(), 0);
}

#[test]
fn a_film_in_a_pipe_is_that_in_a_file_whatever_pictures_exist() {
    let folder = folder();
    let outputs = ["-o", "a.y4m", "-o", "f-#.png", "-o", "-"];
    let arguments = sequence(&[&FOUR[..], &outputs].concat());
    let piped = |arguments: &[&str]| {
        let output = folder.command(arguments).output().unwrap();
        assert!(output.status.success());
        output.stdout
    };
    let first = piped(&arguments);
    assert_eq!(y4m(&first).len(), 4);
    assert!(first == folder.read("a.y4m"));
    for missing in [["f-1.png", "f-2.png"], ["f-0.png", "f-3.png"]] {
        missing
            .iter()
            .for_each(|name| std::fs::remove_file(folder.path(name)).unwrap());
        assert!(piped(&arguments) == first, "{missing:?}");
    }
    let words = "film scene.toml --speeds 0.9 --pictures 3 --beside rest -o b.y4m -o -";
    let both = piped(&words.split(' ').collect::<Vec<_>>());
    assert_eq!(y4m(&both).len(), 3);
    assert!(both == folder.read("b.y4m"));
}

#[test]
fn warnings_and_statistics_of_a_film_for_a_pipe_go_to_standard_error() {
    let folder = folder();
    let far = ["--frames", "0..2", "--fps", "24", "-o", "-"];
    let run = |more: &[&str]| {
        let arguments = sequence(&[&far[..], more].concat());
        let output = folder.command(&arguments).output().unwrap();
        assert!(output.status.success());
        // Nothing follows the last picture.
        assert_eq!(y4m(&output.stdout).len(), 2);
        String::from_utf8(output.stderr).unwrap()
    };
    let said = run(&["--stats"]);
    assert!(said.starts_with("warning: frames are"), "{said}");
    assert!(said.contains("  camera rays "), "{said}");
    assert_eq!(run(&["--quiet"]), "");
    // The scene alone is no film.
    let scene = folder.ok(&sequence(&["--print-scene", "-o", "-"]));
    assert!(scene.contains("[camera]"), "{scene}");
}

#[test]
#[cfg(unix)]
fn a_full_disk_behind_a_pipe_is_reported() {
    let folder = folder();
    let arguments = sequence(&[&FOUR[..], &["-o", "-"]].concat());
    // Only Linux has this device.
    let Ok(full) = std::fs::OpenOptions::new().write(true).open("/dev/full") else {
        return;
    };
    let output = folder.command(&arguments).stdout(full).output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("standard output"), "{said}");
}
