//! `washboard reproduce` as a user meets it.

#![allow(clippy::unwrap_used)]

mod common;
use common::Folder;
use serde_json::Value;
use std::fs;

#[test]
fn an_unknown_item_is_answered_with_the_nearest() {
    let folder = Folder::new("unknown");
    let (status, out, err) = folder.run("reproduce thesis.fig-43 -o out");
    assert_eq!((status, out.as_str()), (2, ""));
    assert!(
        err.contains("`thesis.fig-43` (did you mean `thesis.fig-4.3`?)") && err.lines().count() == 1,
        "{err}"
    );
    assert!(!folder.0.join("out").exists());
}

#[test]
fn a_chapter_is_one_json_object_with_the_keys_of_the_contract() {
    let folder = Folder::new("chapter");
    let (status, out, _) = folder.run("reproduce thesis.ch-3 --quick --json");
    assert_eq!(status, 0);
    let found: Value = serde_json::from_str(&out).unwrap();
    assert_eq!((found["schema_version"].as_u64(), found["command"].as_str()), (Some(1), Some("reproduce")));
    let items = found["items"].as_array().unwrap();
    assert!(items.len() > 100);
    for item in items {
        for key in ["published", "computed", "tolerance"] {
            assert!(item[key].is_f64(), "{item}");
        }
        assert!(item["item"].as_str().unwrap().starts_with("thesis.") && item["quantity"].is_string());
        assert!(item["agrees"].is_boolean() && item.get("reference_note").is_some());
    }
    assert_eq!(found["counts"]["agree"].as_u64(), Some(items.len() as u64));
}

#[test]
fn a_directory_has_page_figures_and_errata_and_the_page_is_made_again() {
    let folder = Folder::new("directory");
    let (status, out, _) = folder.run("reproduce thesis.fig-4.3 thesis.sec-5.3 -o out");
    assert_eq!(status, 0);
    // a disagreement that is excused names its erratum, and does not fail the run
    assert!(
        out.contains("no, E5.7")
            && out.contains("4 of 6 computed numbers agree")
            && out.contains("report.html"),
        "{out}"
    );
    let read = |name: &str| fs::read_to_string(folder.0.join("out").join(name)).unwrap();
    let (page, svg) = (read("report.html"), read("figures/thesis.fig-4.3.svg"));
    assert!(
        page.contains("4 of 6 computed numbers agree")
            && !page.contains("http://www")
            && svg.contains("passive")
    );
    assert!(read("errata.md").contains("## E5.7"));
    fs::remove_file(folder.0.join("out/report.html")).unwrap();
    assert_eq!(folder.run("report out").0, 0);
    assert_eq!(read("report.html"), page);
    // its own files are replaced when asked, a stranger's are not
    let again = "reproduce thesis.sec-5.3 -o out --overwrite --quiet";
    assert_eq!(folder.run(again).0, 0);
    assert!(!folder.0.join("out/figures").exists());
    fs::create_dir(folder.0.join("out/figures")).unwrap();
    fs::write(folder.0.join("out/figures/mine.txt"), "1").unwrap();
    let (status, _, err) = folder.run(again);
    assert!(status == 2 && err.contains("mine.txt"), "{err}");
}

#[test]
fn names_are_listed_and_what_quick_leaves_out_is_said() {
    let folder = Folder::new("list");
    let (status, out, err) = folder.run("reproduce --list");
    assert_eq!((status, err.as_str()), (0, ""));
    assert!(out.lines().any(|l| l.starts_with("thesis.ch-3 ") && l.contains(" items")), "{out}");
    assert!(out.lines().any(|l| l.starts_with("thesis.fig-2.1 ") && l.contains(" long ")), "{out}");
    assert!(out.lines().all(|l| l.chars().count() <= 100), "{out}");
    let (status, out, _) = folder.run("reproduce thesis.fig-2.1 --quick");
    assert!(status == 0 && out.contains("left out by --quick, as they take long: thesis.fig-2.1"), "{out}");
    assert!(!out.contains("0 of 0"), "{out}");
    // a chapter and a panel by their short names; what is read and not computed is counted apart
    let (status, out, _) = folder.run("reproduce fig-5.5-a thesis.table-6.1 -o out");
    assert!(status == 0 && out.contains(" inputs as printed"), "{out}");
    let result: Value =
        serde_json::from_str(&fs::read_to_string(folder.0.join("out/result.json")).unwrap()).unwrap();
    let count = |name: &str| result["counts"][name].as_u64().unwrap();
    let headline = format!("{} of {} computed numbers agree", count("computed_agree"), count("computed"));
    assert!(out.split_whitespace().collect::<Vec<_>>().join(" ").contains(&headline), "{headline}: {out}");
    assert!(out.contains("figures: thesis.fig-5.5") && !out.contains("-o DIR"), "{out}");
    let (status, out, _) = folder.run("reproduce thesis.ch-7 --quick -o quick");
    let errata = fs::read_to_string(folder.0.join("quick/errata.md")).unwrap();
    assert_eq!(status, 0);
    assert!(out.contains("left out by --quick, as they take long: errata E7"), "{out}");
    assert!(errata.contains("**Not all of them**: left out by --quick"), "{errata}");
}
