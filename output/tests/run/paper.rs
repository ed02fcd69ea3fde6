//! The report on paper, and the loads in the pictures of a run.

use super::{read, run, with};
use output::run_results::write_results;
use std::path::Path;

/// The results of a scene: `report.pdf`, `report.txt`, `deployed.svg`.
fn results(folder: &Path, scene: &str) -> [String; 3] {
    let scene = read(folder, scene);
    let designed = run(&scene, None).unwrap();
    write_results(&scene, &designed, false).unwrap();
    ["report.pdf", "report.txt", "deployed.svg"].map(|name| {
        let bytes = std::fs::read(scene.output().join(name)).unwrap();
        String::from_utf8_lossy(&bytes).into_owned()
    })
}

/// The texts of a PDF that are set in a font, in their order. Every text follows the choice of its font.
fn texts(pdf: &str, font: &str) -> Vec<String> {
    let choice = format!("/{font} ");
    let set = pdf.split(&choice).skip(1);
    set.filter_map(|after| {
        let (size, after) = after.split_once('\n')?;
        let (_, text) = after.split_once("Tm\n")?;
        let text = text.split(" Tj").next().filter(|_| size.ends_with(" Tf"))?;
        let text = text.strip_prefix('(')?.strip_suffix(')')?;
        Some(
            text.replace("\\(", "(")
                .replace("\\)", ")")
                .replace("\\\\", "\\"),
        )
    })
    .collect()
}

/// Sides of every page (mm).
fn pages(pdf: &str) -> Vec<[f64; 2]> {
    let boxes = pdf.split("/MediaBox [").skip(1);
    boxes
        .map(|text| {
            let sides: Vec<f64> = (text.split(']').next().unwrap().split(' '))
                .map(|side| side.parse::<f64>().unwrap() * 25.4 / 72.0)
                .collect();
            [sides[2], sides[3]]
        })
        .collect()
}

#[test]
fn the_paper_report_contains_every_line_of_the_text_report() {
    let title =
        "Test sheet (with \\ and parentheses) of a title that needs more than one line of the page";
    // A load far too large: many findings, whose lines are longer than a line of the page.
    for (force, cut) in [("force = [2.0, 0.0]", true), ("force = [3e4, 0.0]", false)] {
        let folder = tempfile::tempdir().unwrap();
        let changes = [
            ("\"Test sheet\"", format!("'{title}'")),
            ("force = [2.0, 0.0]", force.to_owned()),
            ("steps = 25", "steps = 2".to_owned()),
        ];
        let changes = changes.each_ref().map(|(from, to)| (*from, to.as_str()));
        let [pdf, report, _] = results(folder.path(), &with(&changes));
        assert_eq!(report.contains("NO CUT FILE"), !cut);
        let pages = pages(&pdf);
        assert!((1..=3).contains(&pages.len()), "{pages:?}");
        for [width, height] in pages {
            assert!((width - 210.0).abs() < 1e-3 && (height - 297.0).abs() < 1e-3);
        }
        let lines = texts(&pdf, "C");
        let (first, rest) = report.split_once('\n').unwrap();
        // Lines that fit, such as all rows of the tables, are written as they are.
        for line in rest.lines().filter(|line| (1..=114).contains(&line.len())) {
            assert!(lines.iter().any(|found| found == line), "{line}");
        }
        assert!(lines.iter().all(|line| line.len() <= 114));
        let words = |text: &str| {
            text.split_whitespace()
                .map(str::to_owned)
                .collect::<Vec<_>>()
        };
        assert_eq!(words(&lines.join("\n")), words(rest));
        assert_eq!(words(&texts(&pdf, "B").join(" ")), words(first));
        // The numbers of nine panels and twelve hinges on the flat sheet.
        let numbers = texts(&pdf, "F");
        for number in (0..9)
            .map(|k| format!("P{k}"))
            .chain((0..12).map(|h| h.to_string()))
        {
            assert!(numbers.contains(&number), "{number}");
        }
        let [again, ..] = results(folder.path(), &with(&changes));
        assert_eq!(pdf, again, "the same bytes for the same run");
    }
}

/// Every kind of load is drawn, with its magnitude at the load factor of the state.
#[test]
fn all_loads_of_a_state_are_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let changes = [
        (
            "force = [2.0, 0.0]",
            "force = [2.0, 0.0]\n\n[[loads]]\npanel = [1, 2]\ncouple = -25.0\n\n\
             [[edge_loads]]\nedge = \"top\"\ntraction = [0.0, 0.0025]\n\n\
             [[opening_couples]]\npanels = [[1, 0], [2, 0]]\ncouple = 37.0",
        ),
        ("steps = 25", "steps = 1"),
    ];
    let [pdf, _, svg] = results(folder.path(), &with(&changes));
    // 0.0025 N/mm on 1200 mm, over three panels.
    for label in ["2 N", "1 N", "25 N mm", "37 N mm"] {
        assert!(svg.contains(&format!(">{label}</text>")), "{label}");
        assert!(texts(&pdf, "F").contains(&label.to_owned()), "{label}");
    }
    // Four forces and, on panels that rotate freely, three couples.
    assert_eq!(svg.matches("<polyline").count(), 4 + 3);
    let driven = with(&[
        (
            "[target.circle]",
            "[drive]\nstroke = 20.0\n\n[target.circle]",
        ),
        ("steps = 25", "steps = 1"),
    ]);
    let folder = tempfile::tempdir().unwrap();
    let scene = read(folder.path(), &driven);
    let designed = run(&scene, None).unwrap();
    let reached = designed.best.deployment.final_step().load_factor * 2.0;
    let [_, report, svg] = results(folder.path(), &driven);
    let (_, load) = report.split_once("load reached").unwrap();
    let load = load.split(',').next().unwrap().trim();
    assert!(
        (load.strip_suffix(" N").unwrap().parse::<f64>().unwrap() / reached - 1.0).abs() < 1e-3
    );
    assert!(svg.contains(&format!(">{load}</text>")), "{load}");
}
