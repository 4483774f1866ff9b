//! The report in a real browser, where one is installed.

use std::fs;
use std::path::Path;
use std::process::Command;

use nullray::validate::compare::report::{ErrorMap, page};
use nullray::validate::compare::{CompareOptions, Tolerance, compare};

use crate::compare::pictures::light;

/// What reports the report's own width, in a frame that is as wide as a telephone, once it has drawn itself.
const FRAME: &str = r#"<!doctype html><body style="margin:0"><iframe src="report.html" style="width:420px;height:900px;border:0"></iframe>
<script>addEventListener('load', () => setTimeout(() => {
  const page = document.querySelector('iframe').contentDocument;
  const first = page.querySelector('.view img');
  document.body.dataset.found = [page.documentElement.scrollWidth, page.querySelectorAll('img').length,
    [...page.images].every(i => i.naturalWidth > 0), first.style.transform,
    page.querySelector('h1').nextElementSibling.nextElementSibling.className].join('|');
}, 200));</script>"#;

/// The first browser that there is.
fn browser() -> Option<&'static str> {
    let names = ["chromium", "chromium-browser", "google-chrome"];
    let runs = |name: &&str| {
        let version = Command::new(name).arg("--version").output();
        version.is_ok_and(|output| output.status.success())
    };
    names.into_iter().find(runs)
}

#[test]
fn a_browser_draws_the_report_on_420_pixels() {
    let Some(browser) = browser() else {
        crate::common::skipped::skipped("Chromium is not installed");
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let [r, c] = light(61, 47);
    let options = CompareOptions {
        maps: true,
        ..CompareOptions::default()
    };
    let found = compare(&r, &c, &options).unwrap();
    let limit: Tolerance = "rmse=0".parse().unwrap();
    let map = ErrorMap::new(
        "FLIP error",
        &found,
        found.flip.clone().unwrap().map.unwrap(),
    );
    let breaches = found.breaches(&[limit]).unwrap();
    let html = page(&found, &breaches, [&r, &c], &[map]).unwrap();
    fs::write(folder.path().join("report.html"), html).unwrap();
    fs::write(folder.path().join("frame.html"), FRAME).unwrap();
    let dom = dom(browser, folder.path());
    let start = dom.find("data-found=\"").unwrap_or_else(|| panic!("{dom}")) + 12;
    let told: Vec<&str> = dom[start..].split('"').next().unwrap().split('|').collect();
    // No wider than the frame; two pictures, a map and its colour bar, all decoded; zoomed to fit by the script; the
    // exceeded limit first.
    let width: u32 = told[0].parse().unwrap();
    assert!(width <= 420, "{told:?}");
    assert_eq!(
        (told[1], told[2], told[4]),
        ("4", "true", "breaches"),
        "{told:?}"
    );
    assert!(told[3].contains("scale("), "{told:?}");
}

fn dom(browser: &str, folder: &Path) -> String {
    let output = Command::new(browser)
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--allow-file-access-from-files",
        ])
        .arg(format!(
            "--user-data-dir={}",
            folder.join("profile").display()
        ))
        .args(["--virtual-time-budget=5000", "--dump-dom"])
        .arg(format!("file://{}", folder.join("frame.html").display()))
        .output()
        .unwrap();
    String::from_utf8_lossy(&output.stdout).into_owned()
}
