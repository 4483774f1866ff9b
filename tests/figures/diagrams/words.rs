//! Text, colours and quantities of diagrams; text as text.

use nullray::figures::diagram;
use nullray::figures::drawing::{Item, pdf, svg, tikz};
use nullray::scene::Overrides;

use super::{event, laid_out, near, panel, parsed};

const MOVING: &str = "title = \"*β* = {frame.S'.velocity}, {worldline.0.name}\"\n\
                      frame = [{ name = \"S'\", velocity = 0.6 }]\n\
                      worldline = [{ name = \"a_b\", velocity = -0.5 }]\n";

fn title(text: &str, set: &[(&str, &str)]) -> String {
    let overrides = Overrides {
        set: set
            .iter()
            .map(|(k, v)| (k.to_string(), v.to_string()))
            .collect(),
        ..Overrides::default()
    };
    let text = format!("[diagram]\n{text}");
    let model = diagram::parse(&text, "test", "".as_ref(), &overrides).unwrap();
    diagram::draw(&diagram::layout(&model), &model.style)
        .unwrap()
        .title
}

#[test]
fn keys_in_a_title_follow_what_is_set() {
    assert_eq!(title(MOVING, &[]), "β = 0.6, a_b");
    let set = [("diagram.frame.\"S'\".velocity", "-0.25")];
    assert_eq!(title(MOVING, &set), "β = −0.25, a_b");
}

#[test]
fn speeds_of_frames_in_a_title_are_those_that_velocities_make() {
    let frames = "title = \"{frame.S''.velocity} and {frame.S'.velocity} make {frame.S''.speed}\"\n\
                  frame = [{ name = \"S'\", velocity = 0.5 }, { name = \"S''\", velocity = 0.5, relative_to = \"S'\" }]\n";
    assert_eq!(title(frames, &[]), "0.5 and 0.5 make 0.8");
    // (0.8 − 0.5)/(1 − 0.4)
    let set = [
        ("diagram.frame.0.velocity", "0.8"),
        ("diagram.frame.1.velocity", "-0.5"),
    ];
    assert_eq!(title(frames, &set), "−0.5 and 0.8 make 0.5");
}

#[test]
fn no_speed_below_that_of_light_reads_as_1() {
    let one = |velocity: &str| {
        let text = format!(
            "title = \"{{frame.A.velocity}}\"\nframe = [{{ name = \"A\", velocity = {velocity} }}]\n"
        );
        title(&text, &[])
    };
    assert_eq!(one("0.99996"), "0.99996");
    assert_eq!(one("-0.9999"), "−0.9999");
    assert_eq!(one("0.123456"), "0.1235");
    // Two digits of 1 − β = 1.234·10⁻⁶.
    assert_eq!(one("0.999998766"), "0.9999988");
    let frames = "title = \"{frame.S''.speed}\"\nframe = [{ name = \"S'\", velocity = 0.9999 }, \
                  { name = \"S''\", velocity = 0.5, relative_to = \"S'\" }]\n";
    // (0.9999 + 0.5)/(1 + 0.49995) = 0.99996667.
    assert_eq!(title(frames, &[]), "0.999967");
    // γ = 10¹⁰: 1 − β = 1/(2γ²).
    let gamma =
        "title = \"{frame.A.speed}\"\nframe = [{ name = \"A\", velocity = { gamma = 1e10 } }]\n";
    assert_eq!(title(gamma, &[]), "1 − 5·10^{−21}");
}

#[test]
fn the_speed_of_a_frame_is_known_however_the_file_gives_it() {
    let speed = |frame: &str| {
        let text = format!(
            "title = \"{{frame.A.speed}}, {{frame.A.beta}}\"\nframe = [{{ name = \"A\", {frame} }}]\n\
             worldline = [{{ name = \"ship\", velocity = -0.6 }}]\n"
        );
        title(&text, &[])
    };
    assert_eq!(speed("velocity = -0.8"), "0.8, −0.8");
    assert_eq!(speed("velocity = 0"), "0, 0");
    // √(1 − 1/2²)
    assert_eq!(speed("velocity = { gamma = 2 }"), "0.866, 0.866");
    assert_eq!(speed("of = \"ship\""), "0.6, −0.6");
    // Labels, too.
    let text = "frame = [{ name = \"A\", of = \"ship\" }]\nworldline = [{ name = \"ship\", velocity = 0.6 }]\n\
                event = [{ name = \"E\", at = [1, 0], label = \"at {frame.0.speed}\" }]\nx = [-1, 1]\nct = [-1, 2]\n";
    event(&panel(text), "at 0.6");
}

#[test]
fn the_mistake_in_a_frame_is_reported_and_not_the_key_of_its_speed() {
    let text = "[diagram]\ntitle = \"{frame.A.speed}\"\nframe = [{ name = \"A\", velocity = 1 }]";
    let error = parsed(text).unwrap_err().to_string();
    assert!(
        error.contains("frame[0].velocity") && error.contains("not below 1"),
        "{error}"
    );
    let error = parsed(&text.replace("{frame.A", "{frame.B"))
        .unwrap_err()
        .to_string();
    assert!(error.contains("no key"), "{error}");
}

#[test]
fn titles_and_labels_wider_than_the_page_are_broken_or_smaller() {
    let long = "An extremely long title that surely will not fit in the width of a page of one hundred and twenty \
                millimetres and hence has several lines";
    let word = "unbreakable".repeat(12);
    for words in [long, &word] {
        let text = format!(
            "[diagram]\ntitle = \"{words}\"\nworldline = [{{ name = \"a\", velocity = 0.2 }}, {{ name = \"{words}\", velocity = 0.5 }}]"
        );
        let mut model = parsed(&text).unwrap();
        for (width, legend) in [(None, false), (Some(150.0), false), (None, true)] {
            model.style.width = width;
            model.style.legend = legend;
            let drawing = diagram::draw(&diagram::layout(&model), &model.style).unwrap();
            let mut shown = String::new();
            for item in &drawing.items {
                let Item::Text(text) = item else { continue };
                let rect = text.bounds().unwrap();
                let is_in = rect.min[0] >= 0.0
                    && rect.max[0] <= drawing.width
                    && rect.min[1] >= 0.0
                    && rect.max[1] <= drawing.height;
                assert!(is_in, "{}: {rect:?}", text.text.text());
                shown += &text.text.text();
                shown.push(' ');
            }
            // All of its words, in the title and in the label.
            for word in words.split(' ') {
                assert!(shown.matches(word).count() >= 2, "{word}: {shown}");
            }
        }
    }
}

#[test]
fn titles_of_the_classics_name_the_speed_that_is_set() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/diagrams");
    for (file, key) in [
        ("boost", "frame.0"),
        ("doppler-k-calculus", "worldline.Bob"),
        ("ladder-paradox", "frame.0"),
        ("length-contraction", "frame.0"),
        ("light-clock", "frame.0"),
        ("simultaneity", "frame.0"),
        ("time-dilation", "frame.0"),
        ("twin-paradox", "frame.out"),
        ("velocity-addition", "frame.0"),
    ] {
        let set = (format!("diagram.{key}.velocity"), "0.37".to_string());
        let overrides = Overrides {
            set: vec![set],
            ..Overrides::default()
        };
        let model = diagram::load(&folder.join(format!("{file}.toml")), &overrides).unwrap();
        let title = diagram::draw(&diagram::layout(&model), &model.style)
            .unwrap()
            .title;
        // The one number there, but for the other speeds of velocity addition.
        let numbers = title.split(' ').filter(|word| word.starts_with("0."));
        let numbers: Vec<&str> = numbers.collect();
        assert!(numbers.contains(&"0.37"), "{file}: {title}");
        assert!(
            numbers.len() == 1 || file == "velocity-addition",
            "{file}: {title}"
        );
    }
}

#[test]
fn the_note_on_projected_light_fits_onto_narrow_pages() {
    let scene = "[camera]\neye = [0, 0, 0]\nlook_at = [0, 0, -1]\nvelocity = { beta = [0, 0, -0.5] }\n\
                 [[object]]\nname = \"ball\"\nshape = { sphere = { radius = 0.1 } }\norigin = { position = [3, 0, -4], time = \"0 m\" }\n";
    let mut model = parsed(scene).unwrap();
    for width in [340.0, 150.0, 80.0] {
        model.style.width = Some(width);
        let drawing = diagram::draw(&diagram::layout(&model), &model.style).unwrap();
        let notes = drawing.items.iter().filter_map(|item| match item {
            Item::Text(said) if said.text.text().contains("its projection") => Some(said),
            _ => None,
        });
        let notes: Vec<_> = notes.collect();
        assert_eq!(notes.len(), 1, "{width}");
        let bounds = notes[0].bounds().unwrap();
        assert!(
            bounds.min[0] > 2.0 && bounds.max[0] < width - 2.0,
            "{width}: {bounds:?}"
        );
    }
}

#[test]
fn titles_have_no_markup() {
    assert_eq!(
        title(
            "title = \"From *S* to *S*'\"\nevent = [{ name = \"A\", at = [0, 0] }]",
            &[]
        ),
        "From S to S′"
    );
}

#[test]
fn braces_without_a_key_group_as_ever() {
    let text =
        "title = \"*x*_{1.5} {a}\\\\{frame.S\\\\}\"\nevent = [{ name = \"A\", at = [0, 0] }]";
    assert_eq!(title(text, &[]), "x_{1.5} a{frame.S}");
}

#[test]
fn a_key_that_is_not_there_is_refused() {
    let text = "[diagram]\ntitle = \"{frame.T.velocity}\"\nevent = [{ name = \"A\", at = [0, 0] }]";
    let error = parsed(text).unwrap_err().to_string();
    assert!(error.contains("no key"), "{error}");
}

#[test]
fn colours_may_be_hexadecimal() {
    let text =
        "event = [{ name = \"A\", at = [0, 0], colour = \"#12aBff\" }]\nct = [-1, 1]\nx = [-1, 1]";
    let layout = laid_out(text);
    let drawing = diagram::draw(&layout, &Default::default()).unwrap();
    let svg = svg::write(&drawing).unwrap();
    assert!(svg.contains("fill=\"#12abff\""), "{svg}");
    for wrong in ["#12ab", "#12abgg", "cyan"] {
        let text =
            format!("[diagram]\nevent = [{{ name = \"A\", at = [0, 0], colour = \"{wrong}\" }}]");
        let error = parsed(&text).unwrap_err().to_string();
        assert!(error.contains("is not a colour"), "{error}");
    }
}

#[test]
fn one_g_for_a_year_is_the_textbook_journey() {
    // a c/year of 9.80665 m/s² is 9.80665 · 31557600 / 299792458 = 1.03229 /yr: after a year of own time at
    // sinh(1.03229)/1.03229 = 1.18731 yr.
    let panel = panel(
        "unit = \"yr\"\nworldline = [{ name = \"ship\", acceleration = \"1 g\" }]\n\
         event = [{ name = \"A\", on = \"ship\", proper_time = 1 }]",
    );
    let at = event(&panel, "A");
    assert!((at.ct - 1.18731).abs() < 1e-5, "{at:?}");
}

#[test]
fn a_world_line_may_end_where_it_meets_another() {
    // x = 0.5 ct meets x = 2 at ct = 4.
    let panel = panel(
        "worldline = [{ name = \"Bob\", velocity = 0.5, from = [0, 0], until = \"Alice\" }, { name = \"Alice\", at = [0, 2] }]\n\
         ct = [-1, 6]\nx = [-1, 4]",
    );
    let points = &panel.world_lines[0].curve.points;
    near(points[points.len() - 1], 4.0, 2.0);
    let apart = "[diagram]\nworldline = [{ name = \"Bob\", until = \"Alice\" }, { name = \"Alice\", at = [0, 2] }]";
    let error = parsed(apart).unwrap_err().to_string();
    assert!(error.contains("do not meet"), "{error}");
}

#[test]
fn light_beside_the_plane_is_said_to_be_a_projection() {
    // From 3 m along x and 4 m along y: 5 m of light path on 3 m of the diagram.
    let text = "direction = [1, 0, 0]\ndimensions = \"2+1\"\nevent = [{ name = \"A\", at = [0, 3, 4] }]\n\
                worldline = [{ name = \"O\" }]\nsignal = [{ from = \"A\", to = \"O\" }]";
    assert_eq!(panel(text).projected, [false]);
    let scene = "[camera]\neye = [0, 0, 0]\nlook_at = [0, 0, -1]\nvelocity = { beta = [0, 0, -0.5] }\n\
                 [[object]]\nname = \"ball\"\nshape = { sphere = { radius = 0.1 } }\norigin = { position = [3, 0, -4], time = \"0 m\" }\n";
    let model = parsed(scene).unwrap();
    let layout = diagram::layout(&model);
    assert!(layout.panels[0].projected.contains(&true));
    let svg = svg::write_with_text(&diagram::draw(&layout, &model.style).unwrap()).unwrap();
    assert!(svg.contains("its projection"), "{svg}");
}

#[test]
fn text_may_be_text_in_svg_and_is_in_tikz() {
    let layout =
        laid_out("title = \"*γ*_1 = 10^{-9} & more\"\nevent = [{ name = \"Alice\", at = [0, 0] }]");
    let drawing = diagram::draw(&layout, &Default::default()).unwrap();
    let outlines = svg::write(&drawing).unwrap();
    assert!(!outlines.contains("<text"));
    let text = svg::write_with_text(&drawing).unwrap();
    assert!(text.contains(">Alice</tspan></text>"), "{text}");
    assert!(text.contains("font-style=\"italic\">γ</tspan>") && text.contains("&amp; more"));
    assert!(text.len() < outlines.len() / 2);
    // Other fonts are fitted to the room that there is for ours.
    assert!(text.contains("textLength=\"") && text.contains("lengthAdjust=\"spacingAndGlyphs\""));
    // Of a PDF: fonts with a table back to characters, in place of outlines.
    let (outlines, text) = (
        pdf::write(&drawing).unwrap(),
        pdf::write_with_text(&drawing).unwrap(),
    );
    let holds =
        |file: &[u8], what: &str| file.windows(what.len()).any(|part| part == what.as_bytes());
    for part in [
        "/ToUnicode",
        "/CIDFontType0C",
        "/LibertinusSerif-Regular",
        "/LibertinusSerif-Italic",
    ] {
        assert!(holds(&text, part) && !holds(&outlines, part), "{part}");
    }
    let tikz = tikz::write(&drawing).unwrap();
    assert!(tikz.contains("\\begin{tikzpicture}") && tikz.ends_with("\\end{tikzpicture}\n"));
    assert!(tikz.contains("{Alice};"));
    assert!(
        tikz.contains("\\textit{$\\gamma$}\\textsubscript{1} = 10\\textsuperscript{$-$9} \\& more"),
        "{tikz}"
    );
    let open = tikz.matches('{').count() as i64 - tikz.matches('}').count() as i64;
    assert_eq!(open, 0, "braces");
}

#[test]
fn views_side_by_side_have_one_scale() {
    // A length of 1 at rest in each: equally long on the page.
    let layout = laid_out(
        "view = [\"world\", \"S'\"]\nframe = [{ name = \"S'\", velocity = 0.6, axes = false }]\n\
         worldline = [{ name = \"a\", through = [[0, 0], [5, 0]], colour = \"#010203\" }]\n\
         event = [{ name = \"B\", at = [5, 3], frame = \"S'\" }]\n",
    );
    let drawing = diagram::draw(&layout, &Default::default()).unwrap();
    let svg = svg::write(&drawing).unwrap();
    let lengths: Vec<f64> = svg
        .lines()
        .filter(|line| line.contains("stroke=\"#010203\"") && line.contains("d=\"M"))
        .filter_map(|line| {
            let data = line.split("d=\"M").nth(1)?.split('"').next()?;
            let numbers: Vec<f64> = data
                .split(['L', ' '])
                .filter_map(|n| n.parse().ok())
                .collect();
            let [x0, y0] = [numbers[0], numbers[1]];
            let [x1, y1] = [numbers[numbers.len() - 2], numbers[numbers.len() - 1]];
            Some((x1 - x0).hypot(y1 - y0))
        })
        .collect();
    // The world line of 5 at rest is γ √(1 + β²) = 1.25 · 1.16619 times as long in S'.
    assert_eq!(lengths.len(), 2, "{svg}");
    assert!(
        (lengths[1] / lengths[0] - 1.25 * 1.36f64.sqrt()).abs() < 1e-3,
        "{lengths:?}"
    );
}

#[test]
fn views_stand_below_each_other_where_columns_say_so() {
    let page = |style: &str| {
        let body = "view = [\"world\", \"S'\", \"S''\"]\nx = [-1, 1]\nct = [-1, 1]\n\
                    frame = [{ name = \"S'\", velocity = 0.6 }, { name = \"S''\", velocity = 0.8 }]\n";
        let model = parsed(&format!("[diagram]\n{body}{style}")).unwrap();
        let drawing = diagram::draw(&diagram::layout(&model), &model.style).unwrap();
        [drawing.width, drawing.height]
    };
    let [wide, low] = page("");
    let [narrow, high] = page("style = { columns = 2 }\n");
    // Each view has its 340 points; two rows in place of one.
    assert_eq!([wide, narrow], [1020.0, 680.0]);
    assert!((high / low - 2.0).abs() < 1e-9, "{high} {low}");
}
