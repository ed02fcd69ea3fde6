//! `kirigami studio` as a person uses it: a sheet is drawn, opened, designed and cut in Chromium,
//! and no other page is admitted.

use crate::browser::{PATIENCE, Tab};
use crate::common::Workplace;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

/// A studio that runs, with the address that it has printed.
struct Studio {
    program: Child,
    address: String,
}

impl Studio {
    /// Starts in the folder of kirigami, with sheets in the folder of the test.
    fn start(work: &Workplace, scene: &str) -> Self {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let mut command = work.program("studio --no-browser --folder");
        command.arg(work.path("studio")).current_dir(root);
        if !scene.is_empty() {
            command.arg(scene);
        }
        let mut program = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
        let mut line = String::new();
        let mut stdout = BufReader::new(program.stdout.take().unwrap());
        stdout.read_line(&mut line).unwrap();
        // What the commands of the studio print is of no interest, but must go somewhere.
        std::thread::spawn(move || std::io::copy(&mut stdout, &mut std::io::sink()));
        let address = line.trim().strip_prefix("kirigami studio: ").unwrap().to_owned();
        Self { program, address }
    }

    fn host(&self) -> &str {
        self.address.strip_prefix("http://").unwrap().split('/').next().unwrap()
    }

    fn query(&self) -> &str {
        self.address.split('?').nth(1).unwrap()
    }

    /// Ends the studio as Ctrl-C does.
    fn interrupt(&mut self) {
        let id = self.program.id().to_string();
        assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
        assert!(self.program.wait().unwrap().success());
    }

    /// The status and the body of the answer to a request with this head and body.
    fn raw(&self, head: &str, host: &str, body: &[u8]) -> (u16, String) {
        let mut stream = TcpStream::connect(self.host()).unwrap();
        let length = body.len();
        write!(stream, "{head} HTTP/1.1\r\nHost: {host}\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n").unwrap();
        // A server that refuses a long body does not read it to its end.
        let _ = stream.write_all(body);
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        let answer = String::from_utf8_lossy(&answer).into_owned();
        let status = answer.split(' ').nth(1).and_then(|status| status.parse().ok());
        let (_, body) = answer.split_once("\r\n\r\n").unwrap_or_default();
        (status.unwrap_or(0), body.to_owned())
    }

    fn ask(&self, request: &Value) -> u16 {
        let head = format!("POST /request?{}", self.query());
        self.raw(&head, self.host(), request.to_string().as_bytes()).0
    }

    /// The stream of events.
    fn events(&self) -> BufReader<TcpStream> {
        let mut stream = TcpStream::connect(self.host()).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        write!(stream, "GET /events?{} HTTP/1.1\r\nHost: {}\r\n\r\n", self.query(), self.host())
            .unwrap();
        BufReader::new(stream)
    }
}

impl Drop for Studio {
    fn drop(&mut self) {
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}

/// The data of the next event of a kind.
fn next(events: &mut BufReader<TcpStream>, kind: &str) -> Value {
    let mut line = String::new();
    loop {
        let begins = line.trim() == format!("event: {kind}");
        line.clear();
        assert_ne!(events.read_line(&mut line).unwrap(), 0, "the stream has ended");
        if begins {
            return serde_json::from_str(line.trim().strip_prefix("data: ").unwrap()).unwrap();
        }
    }
}

fn scene_on_disk(project: &Path) -> String {
    std::fs::read_to_string(project.join("scene.toml")).unwrap()
}

/// Does something to a sheet, and waits until it is at rest again.
fn after(tab: &mut Tab, action: impl FnOnce(&mut Tab)) {
    let pages = tab.value("Number(document.documentElement.dataset.pages ?? 0)");
    action(tab);
    tab.wait(&format!("document.documentElement.dataset.pages > {pages} && document.documentElement.dataset.saved === 'true'"));
    tab.wait("document.documentElement.dataset.working === ''");
}

/// That the page shows a sheet and its fields.
const DRAWN: &str = "!document.body.classList.contains('empty') && cornersDrawn.length > 0 \
    && document.querySelector('[data-path=\"sheet.panels.0\"]') !== null";

/// Waits until a page that was opened shows a sheet at rest.
fn at_rest(tab: &mut Tab) {
    tab.wait(DRAWN);
    tab.wait("document.documentElement.dataset.working === ''");
}

/// Opens the page of a sheet again: it shows the sheet and its fields, and no script has failed.
fn reload(tab: &mut Tab, studio: &Studio) {
    let error = "document.documentElement.dataset.error ?? null";
    assert_eq!(tab.value(error), Value::Null);
    tab.go(&studio.address);
    tab.wait(DRAWN);
    assert_eq!(tab.value(error), Value::Null);
}

/// That the search of the sheet that is shown has ended.
const FOUND: &str = "/Search: (\\d+ steps|settled)/.test(document.getElementById('summary').textContent) \
    && document.documentElement.dataset.working === ''";

/// Types a number into the field of a key.
fn type_into(tab: &mut Tab, key: &str, number: &str) {
    tab.value(&format!("for (let box = document.querySelector('[data-path=\"{key}\"]').closest('details'); box; box = box.parentElement.closest('details')) box.open = true"));
    tab.click(&format!("[data-path='{key}']"));
    tab.value("document.activeElement.select()");
    tab.call("Input.insertText", json!({ "text": number }));
}

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

const A4: &str = "configs/scenes/a4-plate.toml";

#[test]
fn a_sheet_is_drawn_designed_and_cut_in_the_browser() {
    let work = Workplace::new();
    let mut studio = Studio::start(&work, A4);
    let project = work.path("studio/a4-plate");
    let mut tab = Tab::open(&studio.address);
    at_rest(&mut tab);
    let first = scene_on_disk(&project);
    reload(&mut tab, &studio);

    // A page that is opened while the path is computed shows it, too.
    type_into(&mut tab, "drive.stroke", "41");
    tab.wait("document.getElementById('speed').textContent.includes('draft')");
    reload(&mut tab, &studio);
    tab.wait(
        "run.scene.includes('stroke = 41.0') && document.documentElement.dataset.working === ''",
    );

    // A stroke that is typed shows the new equilibrium at once, and becomes a scene.
    after(&mut tab, |tab| {
        type_into(tab, "drive.stroke", "40");
        tab.wait("document.getElementById('speed').textContent.includes('draft')");
    });
    assert!(scene_on_disk(&project).contains("stroke = 40.0"));

    // The upper right corner of the target is dragged, then moved by keys.
    tab.click("input[value=target]");
    after(&mut tab, |tab| {
        let corner = tab.place("[data-handle='1']");
        tab.drag(corner, [20.0, -15.0]);
    });
    let width = |text: &str| -> f64 {
        let (_, rest) = text.split_once("[target.rectangle]").unwrap();
        let (_, rest) = rest.split_once("size = [").unwrap();
        rest.split(',').next().unwrap().parse().unwrap()
    };
    let dragged = width(&scene_on_disk(&project));
    assert!(dragged > width(&first) + 5.0, "{dragged}");
    after(&mut tab, |tab| {
        tab.value("document.querySelector(\"[data-handle='1']\").focus()");
        tab.press("ArrowRight");
    });
    assert!(width(&scene_on_disk(&project)) > dragged);

    // A drawing is dropped onto the sheet.
    let leaf = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs/targets/leaf.svg");
    after(&mut tab, |tab| tab.drop_file(leaf.to_str().unwrap(), "#stage"));
    assert!(scene_on_disk(&project).contains("[target.svg]"));

    // Undo and redo.
    after(&mut tab, |tab| tab.click("#undo"));
    assert!(scene_on_disk(&project).contains("[target.rectangle]"));
    after(&mut tab, |tab| tab.click("#redo"));
    let drawn = scene_on_disk(&project);
    assert!(drawn.contains("[target.svg]"));

    // A value that the command line refuses is refused in its words, at its field, and not written.
    type_into(&mut tab, "ligament.range.1", "0.2");
    tab.wait("document.querySelector('#studio .at-field')?.textContent.includes('ligament')");
    assert_eq!(scene_on_disk(&project), drawn);
    after(&mut tab, |tab| tab.click("#undo"));
    after(&mut tab, |tab| tab.click("#redo"));
    assert_eq!(scene_on_disk(&project), drawn);

    // Nor is it written when the page is opened again.
    type_into(&mut tab, "ligament.range.1", "0.2");
    tab.wait("document.querySelector('#studio .at-field')?.textContent.includes('ligament')");
    reload(&mut tab, &studio);
    assert_eq!(scene_on_disk(&project), drawn);
    assert_eq!(tab.value("scene.ligament.range[1] > 1"), json!(true));

    // The search is paused and goes on; its steps are seen.
    after(&mut tab, |tab| {
        tab.click("#design");
        tab.wait("/^Step [1-9]/.test(document.getElementById('progress').textContent)");
        tab.click("#design");
    });
    reload(&mut tab, &studio);
    let summary = "document.getElementById('summary').textContent";
    tab.wait(&format!("{summary}.includes('stopped after')"));
    tab.click("#design");
    tab.wait(&format!("{summary}.includes('Search: step ')"));
    reload(&mut tab, &studio);
    tab.wait(FOUND);
    tab.wait(
        "[...document.querySelectorAll('#files a')].some((link) => link.textContent === 'cut.dxf')",
    );
    // The search that is shown belongs to the sheet that is shown.
    let designs = tab.value("designs.length");
    after(&mut tab, |tab| tab.click("#undo"));
    tab.wait(&format!("{summary}.includes('not begun')"));
    after(&mut tab, |tab| tab.click("#redo"));
    tab.wait(FOUND);
    assert_eq!(tab.value("designs.length"), designs);
    reload(&mut tab, &studio);
    tab.wait(FOUND);
    let fetched = "(async () => (await fetch([...document.querySelectorAll('#files a')].find((link) => link.textContent === 'cut.dxf').href)).text())()";
    let fetched = tab.value(fetched);
    assert_eq!(tab.value("document.documentElement.dataset.error ?? null"), Value::Null);

    // The command line repeats it: to the byte.
    let run = project.join("design-1");
    let repeated = work.path("repeated");
    work.output(&format!("design {} --restart --out {}", run.display(), repeated.display()));
    let cut = |folder: &Path| std::fs::read_to_string(folder.join("cut.dxf")).unwrap();
    assert_eq!(cut(&run), cut(&repeated));
    assert_eq!(fetched, json!(cut(&run)));

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
            tab.wait(&format!("[...document.querySelectorAll('#files a')].some((link) => link.textContent === '{name}')"));
        }
        tab.wait(FOUND);
        reload(&mut tab, &studio);
    }
    assert!(run.join("cut/tiles-a4.pdf").is_file() && run.join("cut/lightburn/cut.dxf").is_file());
    // No service cuts its holes.
    tab.value("document.getElementById('machine').value = 'laser-service'");
    tab.click("#write");
    tab.wait(
        "document.getElementById('refusal').textContent.includes('SendCutSend refuses holes of')",
    );
    assert!(!run.join("cut/laser-service").exists());

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
    tab.wait("document.getElementById('new-says').textContent.includes('W within')");
    tab.value("document.getElementById('new-name').value = 'Leaf'");
    picture(&mut tab, "begin");
    after(&mut tab, |tab| tab.click("#new-sheet button"));
    let project = work.path("studio/leaf");
    assert!(scene_on_disk(&project).contains("title = \"Leaf\""));
    let leaf = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs/targets/leaf.svg");
    after(&mut tab, |tab| tab.drop_file(leaf.to_str().unwrap(), "#stage"));
    tab.click("input[value=target]");
    picture(&mut tab, "target");
    tab.click("input[value=look]");
    after(&mut tab, |tab| tab.click("#design"));
    picture(&mut tab, "design");
    tab.value("document.getElementById('paper').value = 'a4'");
    tab.click("#write");
    tab.wait("[...document.querySelectorAll('#files a')].some((link) => link.textContent === 'cut/tiles-a4.pdf')");
    tab.value("document.querySelectorAll('#tools details').forEach((box) => { box.open = box.id === 'out' || box.id === 'designs-box'; })");
    tab.value("document.getElementById('studio').scrollTop = 0");
    picture(&mut tab, "cut");
    assert!(project.join("design-1/cut/tiles-a4.pdf").is_file());
    assert_eq!(tab.value("document.documentElement.dataset.error ?? null"), Value::Null);
}

#[test]
fn panels_are_held_and_pulled_by_clicks() {
    let work = Workplace::new();
    let studio = Studio::start(&work, A4);
    let mut tab = Tab::open(&studio.address);
    at_rest(&mut tab);
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
    tab.wait("document.getElementById('refusal').textContent.includes('use a larger sheet')");
    tab.click("#back");
    assert_eq!(tab.value("document.getElementById('tools').hidden"), json!(false));
}

#[test]
fn nobody_else_is_let_in_and_floods_lose_nothing() {
    let work = Workplace::new();
    let studio = Studio::start(&work, A4);
    let (host, query) = (studio.host(), studio.query());
    let status = |head: &str, host: &str| studio.raw(head, host, b"").0;
    let page = format!("GET /?{query}");
    assert_eq!(status(&page, host), 200);
    // A forwarded port has another number, and an editor adds keys of its own.
    assert_eq!(status(&page, "localhost:1"), 200);
    assert_eq!(status(&format!("GET /?id=7&{query}&x"), host), 200);
    let (code, reason) = studio.raw(&page, "studio.example:80", b"");
    assert!(code == 421 && reason.contains("ssh -L"), "{code} {reason}");
    let silent = TcpStream::connect(host).unwrap();
    assert_eq!(status("GET /", host), 403);
    assert_eq!(status("GET /?token=0", host), 403);
    assert_eq!(status("GET /events?token=0", host), 403);
    assert_eq!(status("POST /request", host), 403);
    for name in ["/etc/passwd", "..%2f..%2fscene.toml", "state.json"] {
        assert_eq!(status(&format!("GET /files/{name}?{query}"), host), 404, "{name}");
    }

    // What is no request is refused with the reason.
    let post = format!("POST /request?{query}");
    let (code, reason) = studio.raw(&post, host, br#"{"do": "fly"}"#);
    assert!(code == 400 && reason.contains("unknown variant `fly`"), "{code} {reason}");
    let long = vec![b'x'; 50 << 20];
    let (code, _) = studio.raw(&post, host, &long);
    // The refusal may be lost with the connection, of which the server reads no more.
    assert!(code == 413 || code == 0, "{code}");

    // Two pages see the same; a page that has gone is forgotten.
    let [mut one, mut other] = [studio.events(), studio.events()];
    drop(studio.events());
    let mut scene = next(&mut one, "scene");
    assert_eq!(next(&mut other, "scene"), scene);
    next(&mut one, "page");
    for i in 1..=10_000 {
        scene["scene"]["drive"]["stroke"] = json!(30.0 + 1e-3 * f64::from(i));
        let by = json!(["test", i]);
        let change = json!({ "do": "change", "scene": scene["scene"], "by": by });
        assert_eq!(studio.ask(&change), 204);
    }
    for events in [&mut one, &mut other] {
        loop {
            let latest = next(events, "scene");
            if latest["by"][1] == json!(10_000) {
                assert_eq!(latest["scene"]["drive"]["stroke"], json!(40.0));
                break;
            }
        }
        next(events, "page");
    }
    let on_disk = scene_on_disk(&work.path("studio/a4-plate"));
    assert!(on_disk.contains("stroke = 40.0"), "{on_disk}");
    // A silent connection is closed: one that stays open ends the test at the patience of its
    // stream.
    silent.set_read_timeout(Some(PATIENCE)).unwrap();
    assert_eq!((&silent).read(&mut [0]).unwrap(), 0);
}

#[test]
fn a_silhouette_becomes_a_cut_file_without_another_control() {
    let work = Workplace::new();
    let studio = Studio::start(&work, "");
    let mut tab = Tab::open(&studio.address);
    tab.wait("document.getElementById('new-says').textContent.includes('W within')");
    let fit = "document.getElementById('fit').textContent.includes('on pins: within')";
    let figure = "document.getElementById('miss').textContent";
    // A drawing that is refused leaves no sheet; why is said where it was dropped, by its name.
    let drawing = two_leaves(&work);
    tab.drop_file(drawing.to_str().unwrap(), "#studio");
    tab.wait("document.getElementById('refusal').checkVisibility() && document.getElementById('refusal').textContent.includes('two leaves.svg')");
    tab.wait("document.documentElement.dataset.working === ''");
    assert!(!work.path("studio/two-leaves").exists());
    let leaf = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs/targets/leaf.svg");
    tab.drop_file(leaf.to_str().unwrap(), "#studio");
    tab.wait("document.getElementById('new-work').textContent.startsWith('Fitting')");
    at_rest(&mut tab);
    tab.wait(fit);
    reload(&mut tab, &studio);
    at_rest(&mut tab);
    tab.wait(fit);
    let fitted = tab.value(figure);
    tab.click("#design");
    tab.wait("document.getElementById('left').textContent.includes('best so far')");
    reload(&mut tab, &studio);
    tab.wait(FOUND);
    assert_ne!(tab.value(figure), fitted);
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
}

#[test]
fn every_control_is_explained_and_no_window_is_too_narrow() {
    let work = Workplace::new();
    let studio = Studio::start(&work, A4);
    let mut tab = Tab::open(&studio.address);
    at_rest(&mut tab);
    let unexplained = "[...document.querySelectorAll('input, select, button')].filter((control) => !control.closest('[title]:not([title=\"\"])')) \
        .map((control) => control.dataset.path ?? control.id)";
    assert_eq!(tab.value(unexplained), json!([]));
    let thickness = tab.value("document.querySelector('[data-path=thickness]').parentNode.title");
    assert!(thickness.as_str().unwrap().ends_with("Range: 0.02 to 10."), "{thickness}");
    for width in [1400, 1280, 820, 390] {
        let size =
            json!({ "width": width, "height": 900, "deviceScaleFactor": 1, "mobile": false });
        tab.call("Emulation.setDeviceMetricsOverride", size);
        for page in ["tools", "new-sheet"] {
            tab.value(&format!("openTools({})", page == "tools"));
            let wider = "[document.documentElement, ...document.querySelectorAll('.card:not(#budget-card)')] \
                .filter((part) => part.scrollWidth > part.clientWidth).map((part) => part.id)";
            assert_eq!(tab.value(wider), json!([]), "{page} at {width} px");
        }
    }
}

/// The texts of a page whose contrast is below 4.5, and the fields whose border has less than 3,
/// with the contrast.
const FAINT: &str = r"(() => {
    const numbers = (colour) => colour.match(/[\d.]+/g).map(Number);
    const light = (colour) => numbers(colour).slice(0, 3).map((c) => c / 255).map((c) => (c <= 0.03928 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4))
        .reduce((sum, c, i) => sum + [0.2126, 0.7152, 0.0722][i] * c, 0);
    const ground = (part) => {
        const colour = part ? getComputedStyle(part).backgroundColor : 'rgb(255, 255, 255)';
        return numbers(colour)[3] === 0 ? ground(part.parentElement) : colour;
    };
    const contrast = (one, other) => { const [low, high] = [light(one), light(other)].sort((a, b) => a - b); return (high + 0.05) / (low + 0.05); };
    const shown = [...document.querySelectorAll('body *')].filter((part) => part.checkVisibility() && !part.closest('svg, [disabled], .stale'));
    const texts = shown.filter((part) => [...part.childNodes].some((node) => node.nodeType === 3 && node.textContent.trim()));
    const of = (parts, style, least, behind) => parts.map((part) => [part.tagName, part.id, contrast(getComputedStyle(part)[style], ground(behind(part)))])
        .filter(([, , found]) => found < least);
    const fields = shown.filter((part) => part.matches('select, input[type=number], input:not([type])'));
    return [...of(texts, 'color', 4.5, (part) => part), ...of(fields, 'borderTopColor', 3, (part) => part.parentElement)];
})()";

#[test]
fn texts_are_legible_and_controls_have_names_on_light_and_dark_screens() {
    let work = Workplace::new();
    let studio = Studio::start(&work, "");
    let mut tab = Tab::open(&studio.address);
    tab.wait("document.querySelectorAll('#examples img').length === 3");
    let check = |tab: &mut Tab| {
        for theme in ["light", "dark"] {
            tab.prefer(theme);
            assert_eq!(tab.value(FAINT), json!([]), "{theme}");
        }
        let nameless = "[...document.querySelectorAll('input, select, button')].filter((control) => \
            !control.labels?.length && !control.ariaLabel && !control.textContent.trim()).map((control) => control.outerHTML)";
        assert_eq!(tab.value(nameless), json!([]));
        let twice = "[...document.querySelectorAll('[id]')].map(({ id }) => id).filter((id, i, all) => all.indexOf(id) !== i)";
        assert_eq!(tab.value(twice), json!([]));
    };
    check(&mut tab);
    // A finished sheet opens as it is, and its files are written without a search.
    tab.click("#examples button");
    at_rest(&mut tab);
    tab.value("document.querySelectorAll('#tools details').forEach((box) => { box.open = true; })");
    check(&mut tab);
    let widths = || {
        let scene = scene_on_disk(&work.path("studio/heart"));
        let line = scene.lines().find(|line| line.starts_with("w_lig"));
        line.unwrap().to_owned()
    };
    let first = widths();
    tab.click("#write");
    tab.wait(
        "[...document.querySelectorAll('#files a')].some((link) => link.textContent === 'cut.dxf')",
    );
    assert_eq!(widths(), first);
    // The cheapest level that is accurate enough for this sheet.
    tab.value("document.querySelector('[data-fields=search] .actions input').value = 1000");
    tab.value("[...document.querySelectorAll('button')].find((button) => button.textContent === 'Cheapest within').click()");
    tab.wait("scene.level === 'pin'");
}

#[test]
fn a_new_sheet_has_the_tool_of_its_service_and_fits_on_its_stock() {
    let work = Workplace::new();
    let studio = Studio::start(&work, "");
    let mut events = studio.events();
    let request = |name: &str, service: &str| json!({ "do": "new", "name": name, "material": null, "thickness": null, "size": null, "stock": "a4", "margin": 5, "kerf": null, "service": service, "drawing": null });
    assert_eq!(studio.ask(&request("refused", "SnapCut")), 204);
    let said = next(&mut events, "says");
    let message = said["message"].as_str().unwrap();
    assert!(message.contains("SnapCut wants holes of 4.50 mm"), "{message}");
    assert!(!work.path("studio/refused").exists());
    assert_eq!(studio.ask(&request("plate", "SendCutSend")), 204);
    let scene = &next(&mut events, "scene")["scene"];
    let process = &scene["process"];
    assert_eq!((&process["hole_diameter"], &process["slit_width"]), (&json!(1.6), &json!(1.5)));
    assert_eq!(scene["cutting"]["kerf"], Value::Null);
    assert_eq!(scene["sheet"]["size"], json!([197.0, 284.0]));
    // The service accepts every ligament of the range.
    let narrowest = scene["ligament"]["range"][0].as_f64().unwrap();
    assert!(narrowest - 0.8 >= 1.5, "{narrowest}");
}

/// Another thickness scales the holes and the slots of a service, which no tool has set.
#[test]
fn a_sheet_for_a_service_has_another_thickness() {
    let work = Workplace::new();
    let studio = Studio::start(&work, "configs/examples/service-plate.toml");
    let mut tab = Tab::open(&studio.address);
    at_rest(&mut tab);
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

#[test]
fn what_was_changed_last_is_on_disk_when_the_studio_ends() {
    let work = Workplace::new();
    let mut studio = Studio::start(&work, A4);
    let mut scene = next(&mut studio.events(), "scene");
    scene["scene"]["drive"]["stroke"] = json!(41.5);
    let change = json!({ "do": "change", "scene": scene["scene"], "by": ["test", 1] });
    assert_eq!(studio.ask(&change), 204);
    // A search that is asked for twice and paused at once makes no step.
    for request in ["design", "design", "pause"] {
        assert_eq!(studio.ask(&json!({ "do": request })), 204);
    }
    studio.interrupt();
    let project = work.path("studio/a4-plate");
    assert!(scene_on_disk(&project).contains("stroke = 41.5"));
    assert!(!project.join("design-2").exists());
}

#[test]
fn the_scene_of_a_user_is_not_changed() {
    let work = Workplace::new();
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join(A4);
    let before = std::fs::read(&scene).unwrap();
    let studio = [0, 1].map(|_| Studio::start(&work, A4));
    let files = studio.each_ref().map(|studio| {
        let mut sheet = next(&mut studio.events(), "sheet");
        PathBuf::from(sheet["file"].take().as_str().unwrap())
    });
    // Each studio has a copy of its own, with runs of its own.
    let copy = std::fs::read_to_string(&files[0]).unwrap();
    assert!(copy.contains("output = \"design-1\"") && !copy.contains("\"/"), "{copy}");
    assert_eq!(
        files,
        ["a4-plate", "a4-plate-2"].map(|name| work.path("studio").join(name).join("scene.toml"))
    );
    assert_eq!(std::fs::read(&scene).unwrap(), before);
    work.refuses("studio configs/scenes/nothing.toml --no-browser", &["nothing.toml"]);
}
