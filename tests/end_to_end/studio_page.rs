//! The page of `kirigami studio` as a person uses it: a sheet is drawn, opened, designed and cut in
//! Chromium.

use crate::browser::Tab;
use crate::common::Workplace;
use crate::studio::{
    A4, FOUND, Studio, after, assert_no_error, at_rest, drop_leaf, lists, next, opened, reload,
    says, scene_on_disk, type_into,
};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// A drawing with two paths, which is refused.
fn two_leaves(work: &Workplace) -> PathBuf {
    let drawing = work.path("two leaves.svg");
    let leaf = |at: u32| format!("<path d='M{at} 0L{at} 3L0 3Z'/>");
    let svg = format!(
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 9 9'>{}{}</svg>",
        leaf(4),
        leaf(8)
    );
    std::fs::write(&drawing, svg).unwrap();
    drawing
}

#[test]
fn a_sheet_is_drawn_designed_and_cut_in_the_browser() {
    let work = Workplace::new();
    let (mut studio, mut tab) = opened(&work, A4);
    let project = work.path("studio/a4-plate");
    draw(&mut tab, &studio, &project);
    let fetched = search(&mut tab, &studio);

    // The command line repeats it: to the byte.
    let run = project.join("design-1");
    let repeated = work.path("repeated");
    work.output(&format!("design {} --restart --out {}", run.display(), repeated.display()));
    let cut = |folder: &Path| std::fs::read_to_string(folder.join("cut.dxf")).unwrap();
    assert_eq!(cut(&run), cut(&repeated));
    assert_eq!(fetched, json!(cut(&run)));
    write_files(&mut tab, &studio, &run);

    // The page says when the studio has ended; the next one opens the sheet as it was.
    let left = scene_on_disk(&project);
    studio.interrupt();
    tab.wait("!document.getElementById('offline').hidden");
    let again = Studio::start(&work, project.to_str().unwrap());
    let copied = Studio::start(&work, run.to_str().unwrap());
    let opened = [(&again, &project), (&copied, &work.path("studio/design-1"))];
    for (studio, project) in opened {
        let mut events = studio.events();
        let sheet = next(&mut events, "sheet");
        assert_eq!(sheet["file"], json!(project.join("scene.toml")));
        let files = next(&mut events, "files")["files"].to_string();
        assert!(files.contains("cut.dxf"), "{files}");
        let page = next(&mut events, "page");
        let end = page["page"]["end_of_search"].as_str().unwrap();
        assert!(end.contains("steps") && !end.contains("stopped"), "{end}");
        assert_eq!(page["run"], json!("design-1"));
        assert_eq!(cut(&project.join("design-1")), cut(&run));
    }
    assert_eq!(scene_on_disk(&project), left);
}

/// Draws the sheet: its stroke, its target, and a key with a value that is refused.
fn draw(tab: &mut Tab, studio: &Studio, project: &Path) {
    let first = scene_on_disk(project);
    reload(tab, studio);

    // A page that is opened while the path is computed shows it, too.
    type_into(tab, "drive.stroke", "41");
    tab.wait(&says("speed", "draft"));
    reload(tab, studio);
    tab.wait(
        "run.scene.includes('stroke = 41.0') && document.documentElement.dataset.working === ''",
    );

    // A stroke that is typed shows the new equilibrium at once, and becomes a scene.
    after(tab, |tab| {
        type_into(tab, "drive.stroke", "40");
        tab.wait(&says("speed", "draft"));
    });
    assert!(scene_on_disk(project).contains("stroke = 40.0"));

    // The upper right corner of the target is dragged, then moved by keys.
    tab.click("input[value=target]");
    after(tab, |tab| {
        let corner = tab.place("[data-handle='1']");
        tab.drag(corner, [20.0, -15.0]);
    });
    let width = |text: &str| -> f64 {
        let (_, rest) = text.split_once("[target.rectangle]").unwrap();
        let (_, rest) = rest.split_once("size = [").unwrap();
        rest.split(',').next().unwrap().parse().unwrap()
    };
    let dragged = width(&scene_on_disk(project));
    assert!(dragged > width(&first) + 5.0, "{dragged}");
    after(tab, |tab| {
        tab.value("document.querySelector(\"[data-handle='1']\").focus()");
        tab.press("ArrowRight");
    });
    assert!(width(&scene_on_disk(project)) > dragged);

    // A drawing is dropped onto the sheet.
    after(tab, |tab| drop_leaf(tab, "#stage"));
    assert!(scene_on_disk(project).contains("[target.svg]"));

    // Undo and redo.
    after(tab, |tab| tab.click("#undo"));
    assert!(scene_on_disk(project).contains("[target.rectangle]"));
    after(tab, |tab| tab.click("#redo"));
    let drawn = scene_on_disk(project);
    assert!(drawn.contains("[target.svg]"));

    // A value that the command line refuses is refused in its words, at its field, and not written.
    type_into(tab, "ligament.range.1", "0.2");
    tab.wait("document.querySelector('#studio .at-field')?.textContent.includes('ligament')");
    assert_eq!(scene_on_disk(project), drawn);
    after(tab, |tab| tab.click("#undo"));
    after(tab, |tab| tab.click("#redo"));
    assert_eq!(scene_on_disk(project), drawn);

    // Nor is it written when the page is opened again.
    type_into(tab, "ligament.range.1", "0.2");
    tab.wait("document.querySelector('#studio .at-field')?.textContent.includes('ligament')");
    reload(tab, studio);
    assert_eq!(scene_on_disk(project), drawn);
    assert_eq!(tab.value("scene.ligament.range[1] > 1"), json!(true));
}

/// Searches, also after pauses and undone steps; returns the text of the cut file that the page
/// links.
fn search(tab: &mut Tab, studio: &Studio) -> Value {
    // An even pattern needs no search. This one is paused and goes on; its steps are seen.
    after(tab, |tab| type_into(tab, "optimiser.steps", "20"));
    after(tab, |tab| {
        tab.click("#design");
        tab.wait("/^Step [1-9]/.test(document.getElementById('progress').textContent)");
        tab.click("#design");
    });
    reload(tab, studio);
    let summary = "document.getElementById('summary').textContent";
    tab.wait(&format!("{summary}.includes('stopped after')"));
    tab.click("#design");
    tab.wait(&format!("{summary}.includes('Search: step ')"));
    reload(tab, studio);
    tab.wait(FOUND);
    tab.wait(&lists("cut.dxf"));
    // The search that is shown belongs to the sheet that is shown.
    let designs = tab.value("designs.length");
    after(tab, |tab| tab.click("#undo"));
    tab.wait(&format!("{summary}.includes('not begun')"));
    after(tab, |tab| tab.click("#redo"));
    tab.wait(FOUND);
    assert_eq!(tab.value("designs.length"), designs);
    reload(tab, studio);
    tab.wait(FOUND);
    let fetched = "(async () => (await fetch([...document.querySelectorAll('#files a')].find((link) => link.textContent === 'cut.dxf').href)).text())()";
    let fetched = tab.value(fetched);
    assert_no_error(tab);
    fetched
}

/// Writes tiles and the files of machines, which the page then lists.
fn write_files(tab: &mut Tab, studio: &Studio, run: &Path) {
    // Tiles and the file of a machine, from the run of the sheet that is shown, with what services
    // refuse. Only what was written is said to be.
    tab.click("#write");
    let said = "document.getElementById('progress').textContent";
    tab.wait(&format!("{said}.startsWith('nothing was written')"));
    tab.value("document.getElementById('paper').value = 'a4'");
    tab.value("document.getElementById('machine').value = 'lightburn'");
    tab.click("#write");
    let tiles = "tiles-a4.pdf in ";
    tab.wait(&format!("{said}.startsWith('written: ') && {said}.includes('{tiles}') && {said}.endsWith('cut/lightburn')"));
    for _ in 0..2 {
        for name in ["cut/tiles-a4.pdf", "cut/lightburn/cut.dxf"] {
            tab.wait(&lists(name));
        }
        tab.wait(FOUND);
        reload(tab, studio);
    }
    assert!(run.join("cut/tiles-a4.pdf").is_file() && run.join("cut/lightburn/cut.dxf").is_file());
    // No service cuts its holes.
    tab.value("document.getElementById('machine').value = 'laser-service'");
    tab.click("#write");
    tab.wait(&says("refusal", "SendCutSend refuses holes of"));
    assert!(!run.join("cut/laser-service").exists());
}

/// The tutorial docs/STUDIO.md, whose pictures are written to the folder that STUDIO_PICTURES
/// names.
#[test]
fn the_tutorial_leads_from_an_empty_page_to_a_cut_sheet() {
    let folder = std::env::var_os("STUDIO_PICTURES").map(PathBuf::from);
    let picture = |tab: &mut Tab, name: &str| {
        if let Some(folder) = &folder {
            tab.value("scrollTo(0, 0)");
            std::fs::write(folder.join(format!("studio-{name}.png")), tab.picture()).unwrap();
        }
    };
    let work = Workplace::new();
    let studio = Studio::start(&work, "");
    let mut tab = Tab::open(&studio.address);
    tab.go(&studio.address);
    tab.wait(&says("new-says", "W within"));
    tab.value("document.getElementById('new-name').value = 'Leaf'");
    picture(&mut tab, "begin");
    after(&mut tab, |tab| tab.click("#new-sheet button"));
    let project = work.path("studio/leaf");
    assert!(scene_on_disk(&project).contains("title = \"Leaf\""));
    after(&mut tab, |tab| drop_leaf(tab, "#stage"));
    tab.click("input[value=target]");
    picture(&mut tab, "target");
    tab.click("input[value=look]");
    after(&mut tab, |tab| tab.click("#design"));
    picture(&mut tab, "design");
    tab.value("document.getElementById('paper').value = 'a4'");
    tab.click("#write");
    tab.wait(&lists("cut/tiles-a4.pdf"));
    tab.value("document.querySelectorAll('#tools details').forEach((box) => { box.open = box.id === 'out' || box.id === 'designs-box'; })");
    tab.value("document.getElementById('studio').scrollTop = 0");
    picture(&mut tab, "cut");
    assert!(project.join("design-1/cut/tiles-a4.pdf").is_file());
    assert_no_error(&mut tab);
}

#[test]
fn panels_are_held_and_pulled_by_clicks() {
    let work = Workplace::new();
    let (_studio, mut tab) = opened(&work, A4);
    let project = work.path("studio/a4-plate");
    // A held panel is clicked and released, and clamped.
    tab.click("input[value=grip]");
    let held: [f64; 2] = serde_json::from_value(tab.value(
        "(() => { const at = scene.supports[0].panel; const b = canvas.getBoundingClientRect(); \
         const [x, y] = meanOf(cornersDrawn[at[1] * scene.sheet.panels[0] + at[0]]); return [b.x + x, b.y + y]; })()",
    ))
    .unwrap();
    tab.drag(held, [0.0, 0.0]);
    tab.wait("!document.getElementById('grip-menu').hidden");
    // The menu is used by its elements: it moves with what stands above it.
    tab.value("document.querySelector('#grip-menu button:nth-last-child(2)').click()");
    // Without a support the sheet is free: the page says so, in the words of the command line.
    tab.wait("document.getElementById('studio').innerText.includes('supports')");
    after(&mut tab, |tab| {
        tab.drag(held, [0.0, 0.0]);
        tab.wait("!document.getElementById('grip-menu').hidden");
        tab.value("document.querySelector('#grip-menu button').click()");
    });
    assert!(scene_on_disk(&project).contains("at = \"centroid\""));
    // Another number of columns: nothing of the sheet before is used, and what pulled it pulls it.
    let load = "states.curve.at(-1)[1]";
    let before = tab.value(load).as_f64().unwrap();
    after(&mut tab, |tab| {
        tab.value("document.querySelector('[data-fields=sheet]').open = true");
        type_into(tab, "sheet.panels.0", "4");
        tab.value("document.activeElement.blur()");
    });
    assert!(scene_on_disk(&project).contains("panels = [4, 4]"));
    assert_eq!(tab.value("hingeCount"), json!(24));
    let now = tab.value(load).as_f64().unwrap();
    assert!(now > 0.2 * before && now < 10.0 * before, "{now} N, not {before} N");
    assert_eq!(tab.value("document.getElementById('refusal').hidden"), json!(true));
    // A size that is too small for the material is refused with what to do.
    tab.click("#another");
    for (id, value) in [("new-width", "60"), ("new-height", "60")] {
        tab.value(&format!("document.getElementById('{id}').value = {value}"));
    }
    tab.click("#new-sheet button");
    tab.wait(&says("refusal", "use a larger sheet"));
    tab.click("#back");
    assert_eq!(tab.value("document.getElementById('tools').hidden"), json!(false));
}

#[test]
fn a_silhouette_becomes_a_cut_file_without_another_control() {
    let work = Workplace::new();
    let studio = Studio::start(&work, "");
    let mut tab = Tab::open(&studio.address);
    tab.wait(&says("new-says", "W within"));
    let fit = "document.getElementById('fit').textContent.includes('of the target (common area')";
    let figure = "document.getElementById('miss').textContent";
    // A drawing that is refused leaves no sheet; why is said where it was dropped, by its name.
    let drawing = two_leaves(&work);
    tab.drop_file(drawing.to_str().unwrap(), "#studio");
    tab.wait("document.getElementById('refusal').checkVisibility() && document.getElementById('refusal').textContent.includes('two leaves.svg')");
    tab.wait("document.documentElement.dataset.working === ''");
    assert!(!work.path("studio/two-leaves").exists());
    drop_leaf(&mut tab, "#studio");
    tab.wait("document.getElementById('new-work').textContent.startsWith('Fitting')");
    at_rest(&mut tab);
    tab.wait(fit);
    reload(&mut tab, &studio);
    at_rest(&mut tab);
    tab.wait(fit);
    let fitted = tab.value(figure);
    tab.click("#design");
    tab.wait(FOUND);
    reload(&mut tab, &studio);
    tab.wait(FOUND);
    // An even pattern needs no search.
    assert_eq!(tab.value(figure), fitted);
    assert_eq!(tab.value("document.getElementById('blocking').textContent"), json!(""));
    // Another tab shows the same.
    let mut other = Tab::open(&studio.address);
    at_rest(&mut other);
    assert_eq!(other.value(figure), tab.value(figure));
    // Every file is saved under a name of its own, which begins with the name of the drawing.
    let links = "[...document.querySelectorAll('#files a[download]')].map((link) => link.download)";
    let names: Vec<String> = serde_json::from_value(tab.value(links)).unwrap();
    assert!(names.contains(&"leaf-cut.dxf".to_owned()), "{names:?}");
    assert!(work.path("studio/leaf/design-1/cut.dxf").is_file());

    // A drawing that is refused is refused where it was dropped, by its name, also after the sheet
    // is at rest again.
    let scene = scene_on_disk(&work.path("studio/leaf"));
    tab.drop_file(drawing.to_str().unwrap(), "#stage");
    let says = "document.getElementById('drop-says')";
    tab.wait(&format!("!{says}.hidden && {says}.textContent.includes('two leaves.svg')"));
    at_rest(&mut tab);
    assert_eq!(tab.value(&format!("{says}.hidden")), json!(false));
    assert_eq!(scene_on_disk(&work.path("studio/leaf")), scene);
    // A click on one of its pieces takes that.
    after(&mut tab, |tab| tab.click("#pieces path:nth-of-type(2)"));
    assert!(scene_on_disk(&work.path("studio/leaf")).contains(".svg#2\""));
    picture_under_sliders(&mut tab, &studio, &work);
}

/// A picture of the leaf is traced. A slider shows at once which panels another side gives, and the
/// sheet has them when it stops.
fn picture_under_sliders(tab: &mut Tab, studio: &Studio, work: &Workplace) {
    let leaf = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs/targets/leaf.svg");
    tab.go(&format!("file://{}", leaf.display()));
    let picture = work.path("snapshot.png");
    std::fs::write(&picture, tab.picture()).unwrap();
    reload(tab, studio);
    after(tab, |tab| tab.drop_file(picture.to_str().unwrap(), "#stage"));
    assert!(scene_on_disk(&work.path("studio/leaf")).contains("file = \"snapshot-"));
    let panels = tab.value("fit.panels").as_u64().unwrap();
    let fire = |tab: &mut Tab, id: &str, value: f64, event: &str| {
        tab.value(&format!(
            "(() => {{ const slider = document.getElementById('{id}'); slider.value = {value}; slider.dispatchEvent(new Event('{event}')); }})()"
        ));
    };
    let side = 1.5 * tab.value("fit.smallest").as_f64().unwrap();
    fire(tab, "fit-panel_side", side, "input");
    tab.wait(&says("fit", "panels show about"));
    assert!(tab.value("crop.panels.length").as_u64().unwrap() < panels);
    after(tab, |tab| fire(tab, "fit-panel_side", side, "change"));
    assert!(tab.value("fit.panels").as_u64().unwrap() < panels);
    after(tab, |tab| fire(tab, "fit-threshold", 0.9, "change"));
    assert_eq!(tab.value("fit.side").as_f64(), Some(side));
    // A click on a panel takes it out, a click on its place adds it again.
    let panels = tab.value("fit.panels").as_u64().unwrap();
    tab.value("document.querySelector('[value=cells]').click(); spot = meanOf(boundariesDrawn[0])");
    let pick = |tab: &mut Tab| _ = tab.value("askCell(spot)");
    after(tab, pick);
    assert!(tab.value("fit.panels").as_u64().unwrap() < panels);
    after(tab, pick);
    assert_eq!(tab.value("fit.panels").as_u64(), Some(panels));
    assert_no_error(tab);
}

/// Another thickness scales the holes and the slots of a service, which no tool has set.
#[test]
fn a_sheet_for_a_service_has_another_thickness() {
    let work = Workplace::new();
    let (_studio, mut tab) = opened(&work, "configs/examples/service-plate.toml");
    after(&mut tab, |tab| {
        type_into(tab, "thickness", "2");
        // A field of this kind counts when it is left.
        tab.value("document.activeElement.blur()");
    });
    let scene = scene_on_disk(&work.path("studio/service-plate"));
    for key in ["thickness = 2.0\n", "slit_width = 1.0\n", "hole_diameter = 1.06667\n"] {
        assert!(scene.contains(key), "{key} {scene}");
    }
}
