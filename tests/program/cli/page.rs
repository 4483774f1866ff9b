//! HTML pages: complete, self-contained, and working in a browser.

use std::path::Path;
use std::process::Command;

use super::Folder;
use super::refused::refused;

const SPEEDS: usize = 3;

/// A page of three speeds and two times, with diagrams of four pixels.
fn page(folder: &Folder) -> String {
    let words = "page scene.toml -o page --beta 0.6 --steps 3 --times 2 --grid 2x2 --from|0 m|--to|1 m|--title|A <crate>";
    let (front, back) = words.split_once("--from").unwrap();
    let mut arguments: Vec<_> = front.trim().split(' ').collect();
    arguments.push("--from");
    arguments.extend(back.split('|').filter(|word| !word.is_empty()));
    folder.ok(&arguments);
    String::from_utf8(folder.read("page/index.html")).unwrap()
}

#[test]
fn a_page_is_one_file_that_refers_to_nothing() {
    let folder = Folder::new();
    let html = page(&folder);
    let names = std::fs::read_dir(folder.path("page"))
        .unwrap()
        .map(|e| e.unwrap().file_name());
    assert_eq!(names.collect::<Vec<_>>(), ["index.html"]);
    let lower = html.to_lowercase();
    // No address of another file: what is in data is base 64, which has no colon and no bracket.
    for address in [
        "http:", "https:", "file:", "src=\"/", "@import", "url(", "fetch(",
    ] {
        assert!(!lower.contains(address), "{address}");
    }
    let count = |what: &str| html.matches(what).count();
    // The first picture stands in the page's text, too.
    assert_eq!(count("\"data:image/svg+xml;base64,"), 2 * SPEEDS);
    assert_eq!(
        count("\"data:image/png;base64,"),
        2 * SPEEDS + 2 * 4 * SPEEDS + 1
    );
    assert!(html.contains("<h1>A &lt;crate&gt;</h1>"));
    // Equal steps of rapidity: half of artanh 0.6 is artanh 1/3.
    assert!(
        html.contains("const betas = [0.0, 0.333333333333"),
        "{}",
        &html[..400]
    );
    for part in [
        "lang=\"en\"",
        "<label for=\"speed\">",
        "type=\"range\"",
        "aria-live",
        "name=\"viewport\"",
        "<noscript>",
    ] {
        assert!(html.contains(part), "{part}");
    }
}

#[test]
fn a_page_that_is_too_large_is_refused_and_its_pictures_are_kept() {
    let folder = Folder::new();
    let words = "page scene.toml -o . --steps 2 --no-diagram --max-size";
    let with = |size| [words.split(' ').collect(), vec![size]].concat();
    let run = folder.run(&with("0.001"));
    assert_eq!(run.code, 2);
    assert!(run.message().contains("--max-size"), "{}", run.message());
    let said = folder.ok(&with("1"));
    assert!(said.contains("0 rendered, 2 existed already"), "{said}");
    assert_eq!(folder.names(), ["index.html", "scene.toml"]);
    refused(
        &folder,
        &["page", "scene.toml", "-o", "x", "--grid", "99x99"],
        &["--grid", "400"],
    );
}

/// Moves the sliders through all their values, clicks on a pixel, and says in the title what happened.
const VISITOR: &str = r##"<script>
const shown = new Set(), drawn = new Set();
for (let j = 0; j <= Number(time.max); j++) for (let i = 0; i <= Number(speed.max); i++) {
  time.value = j; speed.value = i;
  speed.dispatchEvent(new Event("input"));
  drawn.add(at("diagram").src);
  shown.add(at("picture").src + at("speed-said").value + at("time-said").value + at("diagram").src.length);
}
// By keyboard: the grid is one stop, and the arrow keys go on from there, not over its edge.
const cells = [...document.querySelectorAll("#cells button")];
const key = key => document.activeElement.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true }));
cells[0].focus();
["ArrowLeft", "ArrowRight", "ArrowDown", "ArrowDown"].forEach(key);
const where = cells.indexOf(document.activeElement), stops = cells.filter(cell => cell.tabIndex === 0).length;
document.activeElement.click();
const named = [...document.querySelectorAll("button, input, img")].filter(e => !(e.getAttribute("aria-label") || e.alt || e.labels?.length)).length;
const wide = document.documentElement.scrollWidth - innerWidth;
const loaded = performance.getEntriesByType("resource").filter(entry => !entry.name.startsWith("data:"));
setTimeout(() => document.title = `shown ${shown.size}, drawn ${drawn.size}, probe ${at("probe").hidden}, ` +
  `${at("probe-picture").naturalWidth > 100}, at ${where} of ${stops}, unnamed ${named}, wider ${wide > 0}, narrow ${innerWidth < 640}, failed ${failed.length}, loaded ${loaded.length}`, 500);
</script></body>"##;

/// Collects errors and requests that the page's policy forbids.
const WATCH: &str = r#"<script>
const failed = [];
addEventListener("error", event => failed.push(event.message));
addEventListener("securitypolicyviolation", event => failed.push(event.blockedURI));
</script><style>"#;

#[test]
fn a_page_lives_in_a_browser() {
    let names = ["chromium", "chromium-browser", "google-chrome", "chrome"];
    let works = |name: &&&str| {
        Command::new(name)
            .arg("--version")
            .output()
            .is_ok_and(|o| o.status.success())
    };
    let Some(browser) = names.iter().find(works) else {
        crate::common::skipped::skipped(format_args!(
            "a_page_lives_in_a_browser (none of {names:?} is installed)"
        ));
        return;
    };
    let folder = Folder::new();
    let html = page(&folder);
    let visited = html
        .replacen("<style>", WATCH, 1)
        .replacen("</body>", VISITOR, 1);
    folder.write("page/visited.html", visited);
    let address = format!("file://{}", folder.path("page/visited.html").display());
    let profile = format!("--user-data-dir={}", folder.path("profile").display());
    let options = [
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        "--window-size=390,844",
        "--virtual-time-budget=5000",
        "--dump-dom",
    ];
    let run = Command::new(browser)
        .args(options)
        .arg(profile)
        .arg(address)
        .output()
        .unwrap();
    let dom = String::from_utf8_lossy(&run.stdout);
    let title = dom
        .split_once("<title>")
        .and_then(|(_, rest)| rest.split_once("</title>"));
    let title = title.map_or("", |(title, _)| title);
    assert_eq!(
        title,
        "shown 6, drawn 6, probe false, true, at 3 of 1, unnamed 0, wider false, narrow true, failed 0, loaded 0",
        "{}",
        Path::new(browser).display()
    );
}

#[test]
fn a_page_does_not_go_to_standard_output() {
    let folder = Folder::new();
    let arguments = ["page", "scene.toml", "--beta", "0.5", "-o", "-"];
    refused(&folder, &arguments, &["-o -", "a page is a directory"]);
}

#[test]
fn a_page_with_diagrams_of_a_stereo_pair_is_refused_before_pictures_are_rendered() {
    let folder = Folder::new();
    let words = "page scene.toml --beta 0.5 --steps 2 --grid 2x2 -o page --set";
    let stereo = ["camera.stereo={interpupillary_distance=\"6 cm\"}"];
    let arguments: Vec<_> = words.split(' ').chain(stereo).collect();
    let run = folder.run(&arguments);
    assert_eq!((run.code, run.stdout.as_str()), (2, ""));
    assert!(run.message().contains("camera.stereo"), "{}", run.message());
    assert_eq!(folder.names(), ["scene.toml"]);
}

#[test]
fn the_pictures_of_a_page_share_one_exposure() {
    let folder = Folder::new();
    let page = ["page", "scene.toml", "--steps", "3", "--no-diagram", "-o"];
    let said = folder.ok(&[&page[..], &["a"]].concat());
    assert!(
        said.contains("one exposure for all frames: by the logarithm of radiance"),
        "{said}"
    );
    let said = folder.ok(&[&page[..], &["b", "--beta", "0.1"]].concat());
    assert!(
        said.contains("one exposure for all frames: white is radiance"),
        "{said}"
    );
    let said = folder.ok(&[&page[..], &["c", "--own-exposure"]].concat());
    assert!(!said.contains("one exposure"), "{said}");
}
