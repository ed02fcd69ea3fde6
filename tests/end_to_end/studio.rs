//! `kirigami studio`: its requests and events, and its page at rest. No other page is admitted.

use crate::browser::{PATIENCE, Tab};
use crate::common::Workplace;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

/// A studio that runs, with the address that it has printed.
pub(crate) struct Studio {
    program: Child,
    pub(crate) address: String,
}

impl Studio {
    /// Starts in the folder of kirigami, with sheets in the folder of the test.
    pub(crate) fn start(work: &Workplace, scene: &str) -> Self {
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
    pub(crate) fn interrupt(&mut self) {
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

    pub(crate) fn ask(&self, request: &Value) -> u16 {
        let head = format!("POST /request?{}", self.query());
        self.raw(&head, self.host(), request.to_string().as_bytes()).0
    }

    /// The stream of events.
    pub(crate) fn events(&self) -> BufReader<TcpStream> {
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
pub(crate) fn next(events: &mut BufReader<TcpStream>, kind: &str) -> Value {
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

pub(crate) fn scene_on_disk(project: &Path) -> String {
    std::fs::read_to_string(project.join("scene.toml")).unwrap()
}

/// Does something to a sheet, and waits until it is at rest again.
pub(crate) fn after(tab: &mut Tab, action: impl FnOnce(&mut Tab)) {
    let pages = tab.value("Number(document.documentElement.dataset.pages ?? 0)");
    action(tab);
    tab.wait(&format!("document.documentElement.dataset.pages > {pages} && document.documentElement.dataset.saved === 'true'"));
    tab.wait("document.documentElement.dataset.working === ''");
}

/// That the page shows a sheet and its fields.
const DRAWN: &str = "!document.body.classList.contains('empty') && cornersDrawn.length > 0 \
    && document.querySelector('[data-path=\"sheet.panels.0\"]') !== null";

/// Waits until a page that was opened shows a sheet at rest.
pub(crate) fn at_rest(tab: &mut Tab) {
    tab.wait(DRAWN);
    tab.wait("document.documentElement.dataset.working === ''");
}

/// Asserts that no script has failed.
#[track_caller]
pub(crate) fn assert_no_error(tab: &mut Tab) {
    assert_eq!(tab.value("document.documentElement.dataset.error ?? null"), Value::Null);
}

/// That the page lists a file of the run.
pub(crate) fn lists(name: &str) -> String {
    format!(
        "[...document.querySelectorAll('#files a')].some((link) => link.textContent === '{name}')"
    )
}

/// That an element has a text.
pub(crate) fn says(id: &str, part: &str) -> String {
    format!("document.getElementById('{id}').textContent.includes('{part}')")
}

/// The outline of a leaf, dropped on an element.
pub(crate) fn drop_leaf(tab: &mut Tab, selector: &str) {
    let leaf = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs/targets/leaf.svg");
    tab.drop_file(leaf.to_str().unwrap(), selector);
}

/// A studio with a page that shows its sheet at rest.
pub(crate) fn opened(work: &Workplace, scene: &str) -> (Studio, Tab) {
    let studio = Studio::start(work, scene);
    let mut tab = Tab::open(&studio.address);
    at_rest(&mut tab);
    (studio, tab)
}

/// Opens the page of a sheet again: it shows the sheet and its fields, and no script has failed.
pub(crate) fn reload(tab: &mut Tab, studio: &Studio) {
    assert_no_error(tab);
    tab.go(&studio.address);
    tab.wait(DRAWN);
    assert_no_error(tab);
}

/// That the search of the sheet that is shown has ended.
pub(crate) const FOUND: &str = "/Search: (\\d+ steps|settled)/.test(document.getElementById('summary').textContent) \
    && document.documentElement.dataset.working === ''";

/// Types a number into the field of a key.
pub(crate) fn type_into(tab: &mut Tab, key: &str, number: &str) {
    tab.value(&format!("for (let box = document.querySelector('[data-path=\"{key}\"]').closest('details'); box; box = box.parentElement.closest('details')) box.open = true"));
    tab.click(&format!("[data-path='{key}']"));
    tab.value("document.activeElement.select()");
    tab.call("Input.insertText", json!({ "text": number }));
}

pub(crate) const A4: &str = "configs/scenes/a4-plate.toml";

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
