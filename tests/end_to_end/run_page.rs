//! The page of a run in a browser: its scripts run without an error, and what it shows is what the
//! report says.

use crate::browser::Tab;
use crate::common::Workplace;
use serde_json::{Value, json};

/// The page of a run in the working folder, at an address in it.
fn page(work: &Workplace, run: &str, address: &str) -> Tab {
    let page = work.path(run).join("run.html");
    Tab::open(&format!("file://{}#{address}", page.display()))
}

/// The document after its scripts have run, and the report of the run.
fn opened(work: &Workplace, run: &str, address: &str) -> (String, Value) {
    let document = page(work, run, address).value("document.documentElement.outerHTML");
    let document = document.as_str().unwrap().to_owned();
    let start: String = document.chars().take(300).collect();
    assert!(!start.contains("data-error"), "{start}");
    // The gauge of the training domain in the page agrees with the run at every state of every
    // hinge.
    assert!(start.contains("data-disagreements=\"0\""), "{start}");
    let report = std::fs::read_to_string(work.path(run).join("report.json")).unwrap();
    (document, serde_json::from_str(&report).unwrap())
}

/// The number of pages on which the page of a run is printed, from a dark screen.
fn printed_pages(work: &Workplace) -> usize {
    let mut tab = page(work, "run", "");
    tab.prefer("dark");
    let pdf = tab.bytes("Page.printToPDF", json!({ "printBackground": true }));
    let text = String::from_utf8_lossy(&pdf);
    text.matches("/Type /Page\n").count()
}

/// The value next to a name in the table of a hinge.
fn cell<'a>(document: &'a str, name: &str) -> &'a str {
    let (_, row) = document.split_once(&format!("<td>{name}</td><td")).unwrap();
    let (_, value) = row.split_once('>').unwrap();
    value.split_once('<').unwrap().0
}

fn number(text: &str) -> f64 {
    let text = text.split(' ').next().unwrap().replace('\u{2212}', "-");
    text.parse().unwrap()
}

#[test]
fn a_sheet_of_springs_shows_its_loads_and_the_numbers_of_a_hinge() {
    let work = Workplace::new();
    let opened_hinge =
        "[[opening_couples]]\npanels = [[1, 1], [2, 1]]\ncouple = 5.0\n\n[target.circle]";
    work.edit("configs/scenes/linear-7x7.toml", &[("[target.circle]", opened_hinge)]);
    work.output("design configs/scenes/linear-7x7.toml --steps 2 --out run");
    let (document, report) = opened(&work, "run", "hinge=17&quantity=moment");
    // One label for each of the four forces, and for the two couples that open a hinge.
    assert_eq!(document.matches(">40 N</text>").count(), 4);
    assert_eq!(document.matches(">5 N mm</text>").count(), 2);
    assert!(document.contains(
        "<td>opening couple, panel P8 (column 2, row 2) and panel P9 (column 3, row 2)</td>"
    ));
    assert!(document.contains("Load step 10 of 10 \u{b7} load factor 1 \u{b7} load 160 N"));
    let row = &report["hinges"][17];
    for (name, key, unit) in
        [("w_lig", "w_lig", 1e-2), ("\u{3b8}", "theta_deg", 1e-2), ("\u{3b7}_a", "eta_a", 1e-4)]
    {
        let (found, expected) = (number(cell(&document, name)), row[key].as_f64().unwrap());
        assert!((found - expected).abs() <= 0.51 * unit, "{name}: {found} {expected}");
    }
    assert!(
        !document.contains("<td>D_peak</td>")
            && document.contains("Moment M_\u{3b8} of the hinges (N mm)")
    );
    let (document, _) = opened(&work, "run", "state=0&hinge=17");
    assert!(
        document.contains("The flat sheet \u{b7} load factor 0") && !document.contains(" N</text>")
    );
    assert_eq!(number(cell(&document, "\u{3b8}")), 0.0);
    assert_eq!(printed_pages(&work), 2);
    // The animation has a frame for every state.
    let animation = std::fs::read(work.path("run/deployment.png")).unwrap();
    let frames = animation.windows(4).filter(|name| name == b"fcTL").count();
    assert_eq!(frames, 11);
    assert!(animation.len() < 1_000_000, "{}", animation.len());
}

/// The colour of a pixel next to the title, on a screen with the given preference.
fn ground(work: &Workplace, preference: &str) -> [u8; 3] {
    let mut tab = page(work, "run", "");
    tab.prefer(preference);
    let picture = std::io::Cursor::new(tab.picture());
    let mut reader = png::Decoder::new(picture).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    [pixels[0], pixels[1], pixels[2]]
}

#[test]
fn the_page_is_dark_on_a_dark_screen() {
    let work = Workplace::new();
    work.output("design configs/scenes/pin-7x7.toml --steps 1 --out run");
    assert_eq!(ground(&work, "dark"), [0x10, 0x15, 0x1a]);
    assert_eq!(ground(&work, "light"), [0xf3, 0xf5, 0xf7]);
}

#[test]
fn a_learned_sheet_shows_damage_and_the_training_domain() {
    let work = Workplace::new();
    // So large a load drives hinges out of the training domain, and one by more than its width.
    work.edit("configs/scenes/pet-3x3.toml", &[("[27.85, 0.0]", "[600.0, 0.0]")]);
    let design = "design configs/scenes/pet-3x3.toml --steps 1 --out run \
                  --weights data/pet-0.5mm/small.safetensors";
    assert!(work.error(design).contains("no cut file"));
    let report = work.read("run/report.json");
    let report: Value = serde_json::from_str(&report).unwrap();
    let hinges = report["hinges"].as_array().unwrap();
    let inside = |row: &Value| row["inside"].as_bool().unwrap();
    let left = hinges.iter().position(|row| !inside(row)).expect("a hinge leaves the domain");
    let (document, _) = opened(&work, "run", &format!("hinge={left}&quantity=d_peak"));
    assert_eq!(cell(&document, "D_peak"), "not known");
    assert!(document.contains("left it at load step") && document.contains("left the domain:"));
    assert!(document.contains("NO CUT FILE: see the findings"));
    assert!(
        document.contains("Shaded: the training domain")
            || document.contains("No state with these")
    );
    let stays = hinges.iter().position(inside).expect("a hinge stays inside");
    let (document, _) = opened(&work, "run", &format!("hinge={stays}"));
    let (found, expected) =
        (number(cell(&document, "maximum")), hinges[stays]["damage"].as_f64().unwrap());
    assert!((found / expected - 1.0).abs() < 1e-2, "{found} {expected}");
}

#[test]
fn a_hostile_title_is_only_text_and_the_page_prints_on_two_sheets() {
    let work = Workplace::new();
    let title = "</script><script>document.title = 'taken'</script>";
    work.edit(
        "configs/scenes/pin-7x7.toml",
        &[("Circle from a square by kinematics, 7 x 7 panels", title)],
    );
    work.output("design configs/scenes/pin-7x7.toml --steps 1 --out run");
    let (document, _) = opened(&work, "run", "state=3");
    assert!(document.contains("<h1 id=\"title\">&lt;/script&gt;&lt;script&gt;"), "shown as text");
    assert!(!document.contains("<title>taken"));
    assert_eq!(printed_pages(&work), 2);
}

/// A browser, the second reader of cut files: slots and outline have the size of the sheet, arcs
/// included, 5 mm from the corner of the page.
#[test]
fn a_browser_reads_the_cut_file_as_large_as_the_sheet() {
    let work = Workplace::new();
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/configs/scenes/a4-plate-service.toml");
    let cut = format!("cut {scene} --for laser-service --design start --json --out cut");
    let said = work.json(&cut);
    let mut tab = Tab::open(&format!("file://{}", work.path("cut/cut.svg").display()));
    let found = tab.value(
        "(() => { const box = document.querySelector('#OUTLINE path').getBBox(), view = document.documentElement.viewBox.baseVal; \
         return [view.x, view.y, box.x, box.y, box.width, box.height, document.querySelectorAll('#CUT path').length]; })()",
    );
    let found: Vec<f64> = serde_json::from_value(found).unwrap();
    let size = |axis: usize| said["features"]["size"][axis].as_f64().unwrap();
    for (found, expected) in found.iter().zip([0.0, 0.0, 5.0, 5.0, size(0), size(1)]) {
        assert!((found - expected).abs() < 1e-3, "{found} {expected}");
    }
    assert!(found[6] > 0.0);
}
