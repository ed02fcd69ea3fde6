//! `design` replaces the files of earlier runs alone.

use crate::common::Workplace;

const SCENE: &str = "configs/scenes/pin-7x7.toml";

#[test]
fn files_that_no_run_has_written_are_not_replaced() {
    let work = Workplace::new();
    let design = format!("design {SCENE} --steps 1 --out runs/a");
    std::fs::create_dir_all(work.path("runs/a")).unwrap();
    for name in ["report.txt", "cut.svg", "state.json", "scene.toml"] {
        let own = work.path("runs/a").join(name);
        std::fs::write(&own, "# my own").unwrap();
        for command in [&design, &format!("{design} --restart")] {
            work.refuses(command, &[name]);
        }
        assert_eq!(std::fs::read(&own).unwrap(), b"# my own");
        let count = std::fs::read_dir(work.path("runs/a")).unwrap().count();
        assert_eq!(count, 1, "nothing is written before the error");
        std::fs::remove_file(own).unwrap();
    }
    work.output(&design);
    work.output(&design);
    work.output(&format!("{design} --restart"));
}

#[test]
fn a_scene_is_not_replaced_by_its_run() {
    let work = Workplace::new();
    std::fs::create_dir(work.path("configs/own")).unwrap();
    let own = work.path("configs/own/scene.toml");
    std::fs::rename(work.path(SCENE), &own).unwrap();
    let text = std::fs::read_to_string(&own).unwrap();
    let output = text.lines().find(|line| line.starts_with("output")).unwrap();
    work.edit("configs/own/scene.toml", &[(output, "output = \".\"  # here")]);
    let before = std::fs::read(&own).unwrap();
    work.refuses("design configs/own/scene.toml --steps 1", &["scene.toml"]);
    assert_eq!(std::fs::read(&own).unwrap(), before);
}
