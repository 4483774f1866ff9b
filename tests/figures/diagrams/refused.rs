//! Refused diagrams, with the position of the error.

use nullray::Error;

use crate::diagrams::parsed;

/// The place and the words of a refusal.
fn refusal(body: &str) -> (String, String, String) {
    match parsed(&format!("[diagram]\n{body}")) {
        Err(Error::Invalid(problem)) => (
            problem.place.to_string(),
            problem.what.to_string(),
            problem.help.to_string(),
        ),
        other => panic!("{other:?}"),
    }
}

#[track_caller]
pub fn check(body: &str, place: &str, what: &str, help: &str) {
    let found = refusal(body);
    assert_eq!(found.0, place, "{found:?}");
    assert!(found.1.contains(what), "{found:?}");
    assert!(found.2.contains(help), "{found:?}");
}

#[test]
fn an_unknown_event_is_refused_with_the_one_that_was_meant() {
    check(
        "event = [{ name = \"turn\", at = [0, 0] }]\ninterval = [{ from = \"trun\", to = \"turn\" }]\n",
        "diagram.interval[0].from",
        "no event \"trun\"",
        "did you mean \"turn\"?",
    );
}

#[test]
fn a_name_that_two_things_of_the_scene_have_is_refused_and_an_unknown_one_with_those_that_there_are()
 {
    let scene = "[[object]]\nname = \"lamp\"\nshape = { box = { size = [1, 1, 1] } }\n\
                 [[light]]\nname = \"lamp\"\nposition = [0, 1, 0]\n\
                 [[source]]\npulse = { position = [0, 0, 0], sigma = \"1 cm\" }\n";
    for (of, what, help) in [
        (
            "lamp",
            "2 things of the scene are named \"lamp\"",
            "a name of its own",
        ),
        (
            "sun",
            "no world line of \"sun\"",
            "those of: lamp, lamp, pulse",
        ),
    ] {
        let body = format!("worldline = [{{ name = \"w\", of = \"{of}\" }}]\n{scene}");
        check(&body, "diagram.worldline[0].of", what, help);
    }
}

#[test]
fn type_and_lines_that_are_larger_than_the_page_are_refused() {
    for key in ["font_size", "line_width"] {
        let place = format!("diagram.style.{key}");
        for (style, page) in [
            (format!("{key} = 1e30"), "340 points wide"),
            (format!("{key} = 341"), "340 points wide"),
            (format!("width = \"25.4 mm\"\n{key} = 73"), "72 points wide"),
        ] {
            let what = format!("`{key}` is in points, and the page is {page}");
            check(
                &format!("[diagram.style]\n{style}\n"),
                &place,
                &what,
                "a few points",
            );
        }
    }
    let what = "no viewer opens a page";
    check(
        "[diagram.style]\nwidth = \"6 m\"\n",
        "diagram.style.width",
        what,
        "\"5 m\"",
    );
}

#[test]
fn rates_that_no_file_can_state_are_refused() {
    for fps in ["1e20", "1e9", "1e-9"] {
        check(
            &format!("[diagram.animation]\nnow = {{ from = 0, to = 1 }}\nfps = {fps}\n"),
            "diagram.animation.fps",
            "files cannot state this rate",
            "25 or 29.97",
        );
    }
}

#[test]
fn an_unknown_frame_is_refused() {
    check(
        "simultaneity = [{ frame = \"S'\", event = [0, 0] }]\n",
        "diagram.simultaneity[0].frame",
        "no frame \"S'\"",
        "\"world\"",
    );
}

#[test]
fn an_unknown_world_line_is_refused() {
    check(
        "worldline = [{ name = \"ship\" }]\nsignal = [{ from = [0, -1], to = \"shp\" }]\n",
        "diagram.signal[0].to",
        "no world line \"shp\"",
        "did you mean \"ship\"?",
    );
}

#[test]
fn numbers_have_the_range_of_all_other_numbers_of_a_scene() {
    check(
        "worldline = [{ name = \"w\", acceleration = 1e31 }]\n",
        "diagram.worldline[0].acceleration",
        "1e31 is beyond 1e30",
        "",
    );
}

#[test]
fn a_spacelike_world_line_is_refused_at_the_event_that_cannot_be_reached() {
    check(
        "worldline = [{ name = \"w\", through = [[0, 0], [1, 0], [2, 3]] }]\n",
        "diagram.worldline[0].through[2]",
        "not within the future light cone",
        "slower than light",
    );
}

#[test]
fn a_frame_at_the_speed_of_light_is_refused() {
    check(
        "frame = [{ name = \"S'\", velocity = 1 }]\n",
        "diagram.frame[0].velocity",
        "is not below 1",
        "|β| is below 1",
    );
}

#[test]
fn events_defined_by_each_other_are_refused() {
    check(
        "event = [{ name = \"A\", at = \"B\" }, { name = \"B\", at = \"A\" }]\n",
        "diagram.event[1].at",
        "in terms of itself",
        "numbers",
    );
}

#[test]
fn limits_that_show_nothing_are_refused() {
    check(
        "x = [5, 9]\nevent = [{ name = \"A\", at = [0, 0] }]\n",
        "diagram.x",
        "nothing in the diagram",
        "leave them out",
    );
    check(
        "ct = [2, 1]\n",
        "diagram.ct",
        "span nothing",
        "smaller number first",
    );
}

#[test]
fn limits_too_close_for_paper_are_not_said_to_be_the_wrong_way_round() {
    check(
        "x = [1e15, 1.0000000001e15]\n",
        "diagram.x",
        "too close to each other",
        "differ by more",
    );
}

#[test]
fn an_arrow_without_a_direction_is_refused_at_its_key() {
    check(
        "event = [{ name = \"P\", at = [0, 1] }, { name = \"Q\", at = [0, 1] }]\narrow = [{ from = \"P\", to = \"Q\" }]\n",
        "diagram.arrow[0].to",
        "no direction",
        "another event",
    );
}

#[test]
fn an_arrow_too_short_to_be_seen_is_drawn_without_a_head() {
    // 1 g turns a world line within a light-year, beside which a metre is nothing.
    let text = "[diagram]\nworldline = [{ name = \"B\", velocity = 0.5 }, { name = \"E\", acceleration = \"-1 g\" }]\n\
                event = [{ name = \"Q\", at = [2, 0.3] }]\narrow = [{ from = [0, 0], to = [1, 0.5], label = \"v\" }]\n";
    let model = parsed(text).unwrap();
    let drawing =
        nullray::figures::diagram::draw(&nullray::figures::diagram::layout(&model), &model.style)
            .unwrap();
    nullray::figures::drawing::svg::write(&drawing).unwrap();
    // Nor is a page too small for its notes an error.
    let small = text.replace("[diagram]\n", "[diagram]\ndirection = [0, 1, 0]\n");
    let mut model = parsed(&small).unwrap();
    (model.style.width, model.style.height) = (Some(10.0), Some(10.0));
    let drawing =
        nullray::figures::diagram::draw(&nullray::figures::diagram::layout(&model), &model.style)
            .unwrap();
    nullray::figures::drawing::svg::write(&drawing).unwrap();
}

#[test]
fn a_line_of_text_that_no_page_has_room_for_is_refused() {
    let long = "x".repeat(401);
    for (text, place) in [
        (format!("title = \"{long}\"\n"), "diagram.title"),
        (
            format!("event = [{{ name = \"A\", at = [0, 0], label = \"{long}\" }}]\n"),
            "diagram.event[0].label",
        ),
        (
            format!("event = [{{ name = \"{long}\", at = [0, 0] }}]\n"),
            "diagram.event[0].name",
        ),
    ] {
        check(&text, place, "401 characters", "at most 400");
    }
}

#[test]
fn a_character_without_a_glyph_is_refused() {
    let (place, ..) = refusal("event = [{ name = \"A\", at = [0, 0], label = \"漢\" }]\n");
    assert_eq!(place, "diagram.event[0].label");
}

#[test]
fn light_that_never_arrives_is_refused() {
    check(
        "worldline = [{ name = \"w\", at = [0, 1], acceleration = 1 }]\nsignal = [{ from = [1, 0], to = \"w\" }]\n",
        "diagram.signal[0].to",
        "never reaches",
        "horizon",
    );
}

#[test]
fn lines_that_do_not_meet_have_no_crossing() {
    check(
        "worldline = [{ name = \"a\" }, { name = \"b\", at = [0, 1] }]\nevent = [{ name = \"X\", cross = [\"a\", \"b\"] }]\n",
        "diagram.event[0].cross",
        "do not cross",
        "meet",
    );
}

#[test]
fn a_world_line_is_said_once() {
    check(
        "worldline = [{ name = \"w\", through = [[0, 0], [1, 0]], acceleration = 1 }]\n",
        "diagram.worldline[0].acceleration",
        "given twice",
        "in one way",
    );
}

#[test]
fn a_line_of_a_scene_needs_a_scene() {
    check(
        "worldline = [{ name = \"w\", of = \"camera\" }]\n",
        "diagram.worldline[0].of",
        "no world line of \"camera\"",
        "no scene",
    );
}

#[test]
fn a_hyperbola_through_the_light_cone_is_refused() {
    check(
        "hyperbola = [{ through = [1, 1] }]\n",
        "diagram.hyperbola[0].through",
        "on the light cone",
        "another event",
    );
}

#[test]
fn endless_signals_need_a_count() {
    check(
        "worldline = [{ name = \"a\" }, { name = \"b\", at = [0, 1] }]\nsignal = [{ from = \"a\", every = 1, to = \"b\" }]\n",
        "diagram.signal[0]",
        "for ever",
        "count",
    );
}

#[test]
fn an_empty_diagram_is_refused() {
    check(
        "title = \"Nothing\"\n",
        "diagram",
        "nothing to draw",
        "worldline",
    );
}

#[test]
fn an_animation_in_which_nothing_changes_is_refused() {
    check(
        "event = [{ name = \"A\", at = [0, 0] }]\nanimation = { frames = 9 }\n",
        "diagram.animation",
        "nothing changes",
        "boost_to",
    );
}

#[test]
fn a_boost_to_an_unknown_frame_is_refused() {
    check(
        "frame = [{ name = \"out\", velocity = 0.5 }]\nanimation = { boost_to = \"uot\" }\n",
        "diagram.animation.boost_to",
        "no frame \"uot\"",
        "\"out\"",
    );
}

#[test]
fn a_boost_to_the_frame_of_the_view_is_refused() {
    check(
        "frame = [{ name = \"out\", velocity = 0.5 }]\nanimation = { boost_to = \"world\" }\n",
        "diagram.animation.boost_to",
        "in this frame already",
        "another frame",
    );
}

#[test]
fn several_views_are_not_boosted() {
    check(
        "view = [\"world\", \"out\"]\nframe = [{ name = \"out\", velocity = 0.5 }]\n\
         animation = { boost_to = \"out\" }\n",
        "diagram.animation.boost_to",
        "several views",
        "one frame",
    );
}

#[test]
fn one_picture_is_not_an_animation() {
    check(
        "event = [{ name = \"A\", at = [0, 0] }]\nanimation = { frames = 1, now = { from = 0, to = 1 } }\n",
        "diagram.animation.frames",
        "1 pictures do not make an animation",
        "2 to 10000",
    );
}

#[test]
fn a_circle_faster_than_light_is_refused() {
    check(
        "worldline = [{ name = \"w\", circle = { radius = 1, period = 6 } }]\n",
        "diagram.worldline[0].circle.period",
        "1.047",
        "longer period",
    );
}

#[test]
fn two_ways_to_accelerate_are_refused() {
    check(
        "worldline = [{ name = \"w\", acceleration = 1, profile = [[0, 0], [1, 1]] }]\n",
        "diagram.worldline[0].profile",
        "given twice",
        "in one way",
    );
}

#[test]
fn a_place_that_a_world_line_never_reaches_is_refused() {
    check(
        "worldline = [{ name = \"w\", at = [0, 1] }]\nplace = [{ event = [0, 0], to = \"w\" }]\n",
        "diagram.place[0].to",
        "never at that place",
        "",
    );
}

#[test]
fn no_columns_of_views_and_too_many_are_refused() {
    for columns in [0, 13] {
        check(
            &format!("style = {{ columns = {columns} }}\n"),
            "diagram.style.columns",
            "cannot stand side by side",
            "1 to 12",
        );
    }
}
