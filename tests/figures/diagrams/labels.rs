//! Positions of labels: not on each other, not on titles, not on lines, and steady from picture to picture.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::LazyLock;

use nullray::figures::diagram::{self, Series, model::Diagram};
use nullray::figures::drawing::{Drawing, Item, Text};
use nullray::figures::pixel_probe;
use nullray::text::{Rect, Segment};

use super::parsed;

fn classics() -> Vec<(String, Diagram)> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("scenes/diagrams");
    let files = std::fs::read_dir(folder).unwrap();
    let mut files: Vec<_> = files.map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let load = |path: &PathBuf| diagram::load(path, &Default::default()).unwrap();
    let name = |path: &PathBuf| path.file_name().unwrap().to_string_lossy().into_owned();
    files.iter().map(|path| (name(path), load(path))).collect()
}

fn drawn(model: &Diagram) -> Drawing {
    diagram::draw(&diagram::layout(model), &model.style).unwrap()
}

/// Texts, and the straight pieces of strokes at least as wide as half a world line.
#[derive(Default)]
struct Page {
    texts: Vec<(String, Rect)>,
    pieces: Vec<[[f64; 2]; 2]>,
    /// Those of thinner ones, down to the edges of planes, that are opaque enough to be read through words.
    thin: Vec<[[f64; 2]; 2]>,
    /// Lines from labels to what they are of.
    leaders: Vec<[[f64; 2]; 2]>,
}

impl Page {
    fn of(drawing: &Drawing) -> Page {
        let mut page = Page::default();
        let all = Rect {
            min: [0.0; 2],
            max: [drawing.width, drawing.height],
        };
        page.add(&drawing.items, &all);
        page
    }

    /// What is seen of `items` within `clip`.
    fn add(&mut self, items: &[Item], clip: &Rect) {
        for item in items {
            match item {
                Item::Text(text) => self.texts.push((name(text), text.bounds().unwrap())),
                Item::Clip { path, items } => self.add(items, &path.bounds().unwrap()),
                Item::Path {
                    path,
                    stroke: Some(stroke),
                    ..
                } if stroke.width == 0.4 && stroke.colour.alpha == 150 => {
                    let [Segment::Move(from), Segment::Line(to)] = path.0[..] else {
                        panic!("a leader is a line")
                    };
                    self.leaders.push([from, to]);
                }
                // World lines and axes; leaders, grids and what is pale are thinner or translucent.
                Item::Path {
                    path,
                    stroke: Some(stroke),
                    ..
                } if stroke.width >= 0.4 && stroke.colour.alpha >= 170 => {
                    let is_line = stroke.width >= 0.7 && stroke.colour.alpha == 255;
                    let mut last = [0.0; 2];
                    for segment in &path.0 {
                        match *segment {
                            Segment::Move(p) => last = p,
                            Segment::Line(p) => {
                                let piece = [last, p];
                                if let Some([s, t]) = within(clip, &piece) {
                                    let at =
                                        |t: f64| [0, 1].map(|i| last[i] + t * (p[i] - last[i]));
                                    let pieces = match is_line {
                                        true => &mut self.pieces,
                                        false => &mut self.thin,
                                    };
                                    pieces.push([at(s), at(t)]);
                                }
                                last = p;
                            }
                            _ => {}
                        }
                    }
                }
                Item::Path { .. } | Item::Image { .. } => {}
            }
        }
    }

    /// Texts that go beyond the page.
    fn beyond(&self, drawing: &Drawing) -> Vec<String> {
        let size = [drawing.width, drawing.height];
        let is_out = |(_, rect): &&(String, Rect)| {
            (0..2).any(|k| rect.min[k] < 0.0 || rect.max[k] > size[k])
        };
        let out = self.texts.iter().filter(is_out);
        out.map(|(text, _)| text.clone()).collect()
    }

    /// Pairs of texts that overlap.
    fn overlaps(&self) -> Vec<String> {
        let mut found = Vec::new();
        for (i, (a, p)) in self.texts.iter().enumerate() {
            for (b, q) in &self.texts[i + 1..] {
                let apart = (0..2).any(|k| p.max[k] <= q.min[k] || q.max[k] <= p.min[k]);
                if !apart {
                    found.push(format!("{a} on {b}"));
                }
            }
        }
        found
    }

    /// Texts whose ink a leader of another one goes through: its own ends beside it.
    fn led_over(&self) -> Vec<String> {
        let is_crossed =
            |(_, rect): &&(String, Rect)| self.leaders.iter().any(|l| crosses(rect, l));
        let crossed = self.texts.iter().filter(is_crossed);
        crossed.map(|(text, _)| text.clone()).collect()
    }

    /// Texts at which a line is interrupted: pieces of lines end as far from their ink as that is left free.
    fn interrupting(&self) -> Vec<String> {
        const FREE: f64 = 0.6;
        let pieces = || self.pieces.iter().chain(&self.thin);
        let is_at_edge = |rect: &Rect, end: &[f64; 2]| {
            let out = [0, 1].map(|k| (rect.min[k] - end[k]).max(end[k] - rect.max[k]));
            (out[0].max(out[1]) - FREE).abs() < 0.01
        };
        let interrupts = |(_, rect): &&(String, Rect)| {
            let ends = pieces().flatten().filter(|end| is_at_edge(rect, end));
            ends.count() >= 2
        };
        let found = self.texts.iter().filter(interrupts);
        found.map(|(text, _)| text.clone()).collect()
    }

    /// Texts whose ink a line goes through.
    fn struck(&self) -> Vec<String> {
        let is_struck =
            |(_, rect): &&(String, Rect)| self.pieces.iter().any(|piece| crosses(rect, piece));
        let struck = self.texts.iter().filter(is_struck);
        struck.map(|(text, _)| text.clone()).collect()
    }
}

fn name(text: &Text) -> String {
    text.text.text()
}

/// Whether a straight piece goes through the inside of a rectangle.
fn crosses(rect: &Rect, piece: &[[f64; 2]; 2]) -> bool {
    within(rect, piece).is_some()
}

/// The part of a straight piece inside a rectangle: the parameters that are within all four sides.
fn within(rect: &Rect, [a, b]: &[[f64; 2]; 2]) -> Option<[f64; 2]> {
    let (mut from, mut to) = (0.0f64, 1.0f64);
    for k in 0..2 {
        let way = b[k] - a[k];
        if way == 0.0 {
            if a[k] <= rect.min[k] || a[k] >= rect.max[k] {
                return None;
            }
            continue;
        }
        let (s, t) = ((rect.min[k] - a[k]) / way, (rect.max[k] - a[k]) / way);
        from = from.max(s.min(t));
        to = to.min(s.max(t));
    }
    (from < to).then_some([from, to])
}

#[test]
fn labels_of_the_classics_are_on_no_label_no_title_and_no_line() {
    for (file, model) in classics() {
        let drawing = drawn(&model);
        let page = Page::of(&drawing);
        assert_eq!(page.beyond(&drawing), Vec::<String>::new(), "{file}");
        assert_eq!(page.overlaps(), Vec::<String>::new(), "{file}");
        assert_eq!(page.struck(), Vec::<String>::new(), "{file}");
        assert_eq!(page.led_over(), Vec::<String>::new(), "{file}");
    }
}

/// The diagrams that scenes have of their own, and those of three pixels of each.
fn automatic() -> Vec<(String, Diagram)> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let names = [
        "corner.toml",
        "dice.toml",
        "lamps.toml",
        "several-velocities.toml",
        "gallery/barn-and-ladder.toml",
        "gallery/trains.toml",
        "gallery/tunnel.toml",
        "gallery/street.toml",
    ];
    let silent = &nullray::render::progress::Silent;
    let mut all = Vec::new();
    for name in names {
        let path = folder.join(name);
        let scene = nullray::scene::load(&path, &Default::default()).unwrap();
        let base = || diagram::load(&path, &Default::default()).unwrap();
        all.push((name.to_string(), base()));
        let [w, h] = scene.camera.size;
        for [x, y] in [[2, 2], [1, 2], [2, 1]] {
            let pixel = [w * x / 4, h * y / 4];
            let probe = pixel_probe::trace(&scene, pixel, 1 << 32, silent).unwrap();
            let model = pixel_probe::diagram(&probe, base(), None, None).unwrap();
            all.push((format!("{name}, pixel {pixel:?}"), model));
        }
    }
    all
}

#[test]
fn labels_of_scenes_and_pixels_are_on_no_label_no_title_and_no_line() {
    let mut found = Vec::new();
    let all = automatic();
    assert_eq!(all.len(), 32);
    for (name, model) in all {
        let drawing = drawn(&model);
        let page = Page::of(&drawing);
        for (what, texts) in [
            ("beyond the page", page.beyond(&drawing)),
            ("on another", page.overlaps()),
            ("on a line", page.struck()),
            ("under a leader", page.led_over()),
        ] {
            found.extend(
                texts
                    .into_iter()
                    .map(|text| format!("{name}: {text} {what}")),
            );
        }
    }
    assert_eq!(found, Vec::<String>::new());
}

#[test]
fn labels_of_the_classics_are_on_no_edge_of_a_plane_and_no_area_s() {
    let mut found = Vec::new();
    for (name, model) in classics() {
        let page = Page::of(&drawn(&model));
        let is_crossed = |rect: &Rect| page.thin.iter().any(|piece| crosses(rect, piece));
        let crossed = page.texts.iter().filter(|(_, rect)| is_crossed(rect));
        found.extend(crossed.map(|(text, _)| format!("{name}: {text}")));
    }
    assert_eq!(found, Vec::<String>::new());
}

/// A sequence that is the same everywhere: x ← 6364136223846793005 x + 1442695040888963407 (Knuth's MMIX).
struct Random(u64);

impl Random {
    fn part(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.part()
    }
}

/// A diagram of a few world lines, events, a frame and a signal, and by turns a light cone, what is simultaneous, an interval,
/// a hyperbola, a second view, or two dimensions of space.
fn random(seed: u64) -> String {
    let mut random = Random(seed);
    let mut text = "[diagram]\ntitle = \"A random diagram\"\n".to_string();
    let beta = random.between(-0.7, 0.7);
    text += &format!("frame = [{{ name = \"S'\", velocity = {beta:.3} }}]\n");
    text += "worldline = [\n";
    for k in 0..2 + (seed % 3) {
        let (x, v) = (random.between(-3.0, 3.0), random.between(-0.8, 0.8));
        text += &format!("{{ name = \"line {k}\", at = [0, {x:.3}], velocity = {v:.3} }},\n");
    }
    text += "]\nevent = [\n";
    for k in 0..3 + (seed % 4) {
        let (ct, x) = (random.between(-2.0, 4.0), random.between(-3.0, 3.0));
        text += &format!("{{ name = \"event {k}\", at = [{ct:.3}, {x:.3}] }},\n");
    }
    text += "]\nsignal = [{ from = \"event 0\", to = \"line 0\", label = \"light\" }]\n";
    text += match seed / 3 % 6 {
        0 => "",
        1 => "light_cone = [{ of = \"event 1\" }]\n",
        2 => "simultaneity = [{ event = \"event 1\", frame = \"S'\", label = \"one time\" }]\n",
        3 => "interval = [{ from = \"event 1\", to = \"event 2\" }]\n",
        4 => "hyperbola = [{ proper_time = 1 }]\nview = [\"world\", \"S'\"]\n",
        _ => "dimensions = \"2+1\"\nlight_cone = [{ of = \"event 1\" }]\n",
    };
    text
}

#[test]
fn labels_of_200_random_diagrams_are_on_no_label_no_title_and_no_line() {
    for seed in 0..200 {
        let model = parsed(&random(seed)).unwrap_or_else(|error| panic!("{seed}: {error}"));
        let drawing = drawn(&model);
        let page = Page::of(&drawing);
        assert_eq!(page.beyond(&drawing), Vec::<String>::new(), "seed {seed}");
        assert_eq!(page.overlaps(), Vec::<String>::new(), "seed {seed}");
        assert_eq!(page.struck(), Vec::<String>::new(), "seed {seed}");
    }
}

#[test]
fn leaders_of_200_random_diagrams_go_over_no_other_label() {
    let (mut led, mut leaders) = (Vec::new(), 0);
    for seed in 0..200 {
        let page = Page::of(&drawn(&parsed(&random(seed)).unwrap()));
        leaders += page.leaders.len();
        led.extend(page.led_over().into_iter().map(|text| (seed, text)));
    }
    assert!(leaders > 100, "{leaders}");
    assert_eq!(led, []);
}

#[test]
fn labels_of_200_random_diagrams_are_steady_in_boosts() {
    let (mut far, mut steps) = (Vec::new(), 0);
    for seed in 0..200 {
        let text = random(seed) + "animation = { boost_to = \"S'\", frames = 97 }\n";
        // Of two views side by side there is no boost.
        let Ok(model) = parsed(&text) else {
            assert!(text.contains("view = ["), "{text}");
            continue;
        };
        for (k, text, way) in jumps_of_first(&model, 6) {
            steps += 1;
            if way >= 8.0 {
                far.push((seed, k, text, way));
            }
        }
    }
    assert!(steps > 5000, "{steps}");
    assert_eq!(far, []);
}

/// By how much labels that are in two pictures move from the one to the next, by what they say.
fn jumps(model: &Diagram) -> Vec<(usize, String, f64)> {
    jumps_of_first(model, usize::MAX)
}

/// The same in so many pictures.
fn jumps_of_first(model: &Diagram, count: usize) -> Vec<(usize, String, f64)> {
    let (mut places, mut found) = (Places::default(), Vec::new());
    for (k, drawing) in Series::new(model).unwrap().take(count).enumerate() {
        let moved = places.go_on(Page::of(&drawing.unwrap()).texts);
        found.extend(moved.into_iter().map(|(text, way)| (k, text, way)));
    }
    found
}

/// Where the labels of a picture are, the second and third of those alike apart.
#[derive(Default)]
struct Places(HashMap<(String, usize), [f64; 2]>);

impl Places {
    /// Goes on to the next picture: by how much its labels have moved that were in the one before.
    fn go_on(&mut self, texts: Vec<(String, Rect)>) -> Vec<(String, f64)> {
        let mut now = HashMap::new();
        for (text, rect) in texts {
            let count = (0..)
                .find(|n| !now.contains_key(&(text.clone(), *n)))
                .unwrap();
            now.insert(
                (text, count),
                [0, 1].map(|i| 0.5 * (rect.min[i] + rect.max[i])),
            );
        }
        let mut moved = Vec::new();
        for (key, at) in &now {
            // Where one of several alike goes, the others are counted anew; what clocks read goes from clock to clock.
            let second = (key.0.clone(), 1);
            let alone = !now.contains_key(&second) && !self.0.contains_key(&second);
            let is_number = key.0.replace('−', "-").parse::<f64>().is_ok();
            if let (Some(last), true, false) = (self.0.get(key), alone, is_number) {
                moved.push((key.0.clone(), (at[0] - last[0]).hypot(at[1] - last[1])));
            }
        }
        self.0 = now;
        moved
    }
}

#[test]
fn labels_are_steady_in_every_series_of_the_classics() {
    let mut series = 0;
    for (file, model) in classics() {
        if model.animation.is_none() {
            continue;
        }
        series += 1;
        for (k, text, way) in jumps(&model) {
            assert!(
                way < 8.0,
                "{file}, picture {k}: {text} jumps by {way} points"
            );
        }
    }
    assert!(series >= 2);
}

/// Every classic as a film: its own, a line of simultaneity that sweeps over it, and boosts to its frames.
fn films() -> Vec<(String, Diagram)> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("scenes/diagrams");
    let mut films = Vec::new();
    for (file, model) in classics() {
        let animated = |text: &str| {
            let set = vec![("diagram.animation".to_string(), text.to_string())];
            let overrides = nullray::scene::Overrides {
                set,
                ..Default::default()
            };
            diagram::load(&folder.join(&file), &overrides)
        };
        let [from, to] = diagram::layout(&model).panels[0].limits.ct;
        // Of as many pictures as there are by default, and of others.
        for frames in ["", ", frames = 61"] {
            let sweep = format!("{{ now = {{ from = {from}, to = {to} }}{frames} }}");
            films.push((format!("{file}, sweep{frames}"), animated(&sweep).unwrap()));
            for frame in model.frames.iter().skip(1).map(|frame| &frame.name) {
                let boost = format!("{{ boost_to = \"{frame}\"{frames} }}");
                // Of two views side by side there is no boost.
                if let Ok(film) = animated(&boost) {
                    films.push((format!("{file} to {frame}{frames}"), film));
                }
            }
        }
        if model.animation.is_some() {
            films.push((file, model));
        }
    }
    films
}

/// What is wrong in the pictures of `films`, which the tests share that look for it: labels that interrupt lines, and labels that jump or are on
/// something.
static WATCHED: LazyLock<[Vec<String>; 2]> = LazyLock::new(|| {
    let films = films();
    assert!(films.len() >= 40, "{}", films.len());
    let [mut interrupting, mut found] = [Vec::new(), Vec::new()];
    for (film, model) in films {
        let mut places = Places::default();
        for (k, drawing) in Series::new(&model).unwrap().enumerate() {
            let drawing = drawing.unwrap();
            let page = Page::of(&drawing);
            let texts = page.interrupting().into_iter();
            interrupting.extend(texts.map(|text| format!("{film}, picture {k}: {text}")));
            let is_crossed = |rect: &Rect| page.thin.iter().any(|piece| crosses(rect, piece));
            let crossed = page.texts.iter().filter(|(_, rect)| is_crossed(rect));
            for (what, texts) in [
                ("beyond the page", page.beyond(&drawing)),
                ("on another", page.overlaps()),
                ("on a line", page.struck()),
                (
                    "on a thin line",
                    crossed.map(|(text, _)| text.clone()).collect(),
                ),
                ("under a leader", page.led_over()),
            ] {
                let all = texts.into_iter();
                found.extend(all.map(|text| format!("{film}, picture {k}: {text} {what}")));
            }
            for (text, way) in places.go_on(page.texts) {
                if way > 8.0 {
                    found.push(format!("{film}, picture {k}: {text} jumps by {way:.1}"));
                }
            }
        }
    }
    [interrupting, found]
});

#[test]
fn labels_of_moving_classics_interrupt_no_lines() {
    let [found, _] = &*WATCHED;
    assert!(found.is_empty(), "{} of\n{}", found.len(), found.join("\n"));
}

#[test]
fn the_number_of_a_tick_is_not_read_as_the_next_word_of_a_label() {
    // That of the first example in the help of the program, of the scene in README, among them.
    let dice = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("scenes/dice.toml");
    let scene = nullray::scene::load(&dice, &Default::default()).unwrap();
    let silent = &nullray::render::progress::Silent;
    let probe = pixel_probe::trace(&scene, [320, 240], 1 << 32, silent).unwrap();
    let base = diagram::load(&dice, &Default::default()).unwrap();
    let pixel = pixel_probe::diagram(&probe, base, None, None).unwrap();
    let pixel = ("dice.toml, pixel [320, 240]".to_string(), pixel);
    for (name, model) in automatic().into_iter().chain([pixel]) {
        let page = Page::of(&drawn(&model));
        for (text, rect) in &page.texts {
            let is_number = text.replace('−', "-").parse::<f64>().is_ok();
            let after = |(before, other): &&(String, Rect)| {
                let gap = rect.min[0] - other.max[0];
                let beside = rect.max[1].min(other.max[1]) - rect.min[1].max(other.min[1]);
                let is_word = before.chars().any(char::is_alphabetic);
                is_word && (0.0..6.0).contains(&gap) && beside > 0.0
            };
            if is_number && let Some((before, _)) = page.texts.iter().find(after) {
                panic!("{name}: {before} {text}");
            }
        }
    }
}

#[test]
fn labels_of_crowded_scenes_are_on_the_page() {
    // Long names at many lines: some have to stand on lines, whose colour shows what is meant, but none is cut off.
    for count in [12, 18, 25] {
        let mut scene = String::from("[camera]\neye = [0, 0, 0]\nlook_at = [0, 0, -1]\n");
        for k in 0..count {
            let [beta, x] = [37, 53].map(|step| f64::from(k * step % 19) / 10.0 - 0.9);
            scene += &format!(
                "[[object]]\nname = \"object number {k} with a long name\"\nshape = {{ sphere = {{ radius = 0.2 }} }}\n\
                 velocity = {{ beta = [{beta}, 0, 0] }}\norigin = {{ position = [{}, 0, -5], time = \"0 m\" }}\n",
                5.0 * x
            );
        }
        let drawing = drawn(&parsed(&scene).unwrap());
        let beyond = Page::of(&drawing).beyond(&drawing);
        assert!(beyond.is_empty(), "{count}: {beyond:?}");
        // And the lines are interrupted there.
        assert!(!Page::of(&drawing).interrupting().is_empty(), "{count}");
    }
}

#[test]
fn labels_of_moving_classics_are_steady_and_on_no_label_no_title_and_no_line() {
    let [_, found] = &*WATCHED;
    assert!(found.is_empty(), "{} of\n{}", found.len(), found.join("\n"));
}

#[test]
fn labels_of_pixels_are_on_the_page_and_on_no_label() {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("scenes");
    for (file, pixel) in [
        ("cube/approaching-0.9.toml", [320, 240]),
        ("cube/still.toml", [200, 300]),
        ("dice.toml", [200, 220]),
        ("dice.toml", [330, 230]),
        ("several-velocities.toml", [300, 250]),
        ("gallery/barn-and-ladder.toml", [320, 200]),
    ] {
        let path = folder.join(file);
        let scene = nullray::scene::load(&path, &Default::default()).unwrap();
        let silent = &nullray::render::progress::Silent;
        let probe = pixel_probe::trace(&scene, pixel, u64::MAX, silent).unwrap();
        for dimensions in ["1+1", "2+1"] {
            let overrides = nullray::scene::Overrides {
                set: vec![("diagram.dimensions".into(), dimensions.into())],
                ..Default::default()
            };
            let base = diagram::load(&path, &overrides).unwrap();
            let model = pixel_probe::diagram(&probe, base, None, None).unwrap();
            let drawing = drawn(&model);
            let page = Page::of(&drawing);
            assert_eq!(
                page.beyond(&drawing),
                Vec::<String>::new(),
                "{file} {pixel:?} {dimensions}"
            );
            assert_eq!(
                page.overlaps(),
                Vec::<String>::new(),
                "{file} {pixel:?} {dimensions}"
            );
        }
    }
}

#[test]
fn events_stay_on_the_page_of_a_boost_with_limits() {
    let (_, model) = classics()
        .into_iter()
        .find(|(file, _)| file == "boost.toml")
        .unwrap();
    let mut pictures = 0;
    let mut missing = [0; 2];
    for drawing in Series::new(&model).unwrap() {
        let drawing = drawing.unwrap();
        pictures += 1;
        let texts = Page::of(&drawing).texts;
        for (missing, event) in missing.iter_mut().zip(["A", "B"]) {
            // A name is left out for one picture where it changes to the other side of a line.
            match texts.iter().any(|(text, _)| text == event) {
                true => *missing = 0,
                false => *missing += 1,
            }
            assert!(*missing <= 1, "{event}");
        }
        // A, B, and no dot cut off by an edge.
        let whole = dots(&drawing.items);
        assert_eq!(whole.len(), 2);
        for (at, _) in whole {
            let [x, y] = at;
            assert!((4.0..drawing.width - 4.0).contains(&x), "{at:?}");
            assert!((4.0..drawing.height - 4.0).contains(&y), "{at:?}");
        }
    }
    assert_eq!(pictures, 96);
}

#[test]
fn the_start_of_the_ships_stays_on_the_page_of_a_boost_with_limits() {
    let films = films();
    let (_, model) = films
        .iter()
        .find(|(name, _)| name == "bell-spaceships.toml to S'")
        .unwrap();
    for drawing in Series::new(model).unwrap() {
        let page = Page::of(&drawing.unwrap());
        // The clocks show 1 after it, and 2 at R and F.
        let ones = page.texts.iter().filter(|(text, _)| text == "1").count();
        assert!(ones >= 2, "{ones}");
    }
}

#[test]
fn events_of_the_classics_stay_on_the_page_at_all_speeds() {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("scenes/diagrams");
    let mut seen = 0;
    for (file, model) in classics() {
        let key = match file.as_str() {
            "doppler-k-calculus.toml" => "diagram.worldline.Bob.velocity".to_string(),
            _ if model.frames.iter().any(|frame| frame.name == "S'") => {
                "diagram.frame.\"S'\".velocity".to_string()
            }
            _ => continue,
        };
        for beta in ["-0.9", "-0.3", "0.3", "0.9"] {
            let overrides = nullray::scene::Overrides {
                set: vec![(key.clone(), beta.to_string())],
                ..Default::default()
            };
            // Frames that move along with what accelerates have no velocity of their own.
            let Ok(model) = diagram::load(&folder.join(&file), &overrides) else {
                continue;
            };
            for panel in diagram::layout(&model).panels {
                for event in panel.events.iter().filter(|event| event.dot) {
                    seen += 1;
                    let what = format!("{file} at {beta}: {:?}", event.label);
                    assert!(panel.limits.contains(event.at), "{what}");
                }
            }
        }
    }
    assert!(seen >= 120, "{seen}");
}

#[test]
fn no_line_is_drawn_twice() {
    for (file, model) in classics() {
        let svg = nullray::figures::drawing::svg::write(&drawn(&model)).unwrap();
        let mut seen = std::collections::HashSet::new();
        for line in svg.lines().filter(|l| l.starts_with("<path fill=\"none\"")) {
            let data = line.split(" d=\"").nth(1).unwrap();
            assert!(seen.insert(data.to_string()), "{file}: {line}");
        }
    }
}

#[test]
fn ticks_of_the_sensor_s_axes_in_figures_3_and_8_have_their_numbers() {
    let load = |file: &str| {
        let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("scenes/paper");
        diagram::load(&path.join(file), &Default::default()).unwrap()
    };
    let model = load("figure-03.toml");
    let page = Page::of(&drawn(&model));
    for number in ["0.2", "0.4", "0.6", "0.8"] {
        let count = page.texts.iter().filter(|(text, _)| text == number);
        // On ct, x, ct′ and x′.
        assert_eq!(count.count(), 4, "{number}");
    }
    for panel in diagram::layout(&load("figure-08.toml")).panels {
        assert_eq!(panel.axes.len(), 4);
        for axis in panel.axes.iter().flat_map(|axes| [&axes.time, &axes.space]) {
            let numbered = axis.ticks.iter().filter(|tick| tick.label.is_some());
            assert!(numbered.count() > 0, "{}: {}", panel.frame, axis.label);
        }
    }
}

/// Filled shapes as large as dots: their places and colours.
fn dots(items: &[Item]) -> Vec<([f64; 2], nullray::figures::drawing::Colour)> {
    let of = |item: &Item| match item {
        Item::Clip { items, .. } => dots(items),
        Item::Path {
            path,
            fill: Some(fill),
            stroke: None,
        } => {
            let rect = path.bounds().unwrap();
            let [w, h] = [0, 1].map(|k| rect.max[k] - rect.min[k]);
            let middle = [0, 1].map(|k| 0.5 * (rect.min[k] + rect.max[k]));
            let is_dot = w < 8.0 && (w - h).abs() < 1e-6;
            is_dot
                .then_some((middle, fill.colour))
                .into_iter()
                .collect()
        }
        _ => Vec::new(),
    };
    items.iter().flat_map(of).collect()
}

#[test]
fn numbers_of_figure_9_stand_nearest_to_dots_of_their_own_colour() {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("scenes/paper/figure-09.toml");
    let drawing = drawn(&diagram::load(&path, &Default::default()).unwrap());
    let dots = dots(&drawing.items);
    assert_eq!(dots.len(), 10);
    let mut found = 0;
    for item in &drawing.items {
        let Item::Text(text) = item else { continue };
        if !name(text).starts_with("0.") {
            continue;
        }
        let rect = text.bounds().unwrap();
        let away = |at: &[f64; 2]| {
            let off = [0, 1].map(|k| (rect.min[k] - at[k]).max(at[k] - rect.max[k]).max(0.0));
            // Beside counts before above and below.
            off[0].hypot(off[1])
        };
        let mut near: Vec<_> = dots
            .iter()
            .map(|(at, colour)| (away(at), *colour))
            .collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        assert_eq!(near[0].1, text.colour, "{}", name(text));
        // And no other is nearly as near.
        assert!(
            near[1].0 > 1.5 * near[0].0,
            "{}: {:?}",
            name(text),
            &near[..2]
        );
        found += 1;
    }
    assert!(found >= 3, "{found}");
}
