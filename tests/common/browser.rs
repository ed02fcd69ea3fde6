//! A tab of Chromium that a test uses as a person does, by the DevTools protocol over two pipes.
#![allow(dead_code)] // every test program uses only a part

use base64::Engine;
use serde_json::{Value, json};
use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Longest time that a page may take for what a test waits for.
pub(crate) const PATIENCE: Duration = Duration::from_secs(90);

/// A tab; the browser ends with it.
pub(crate) struct Tab {
    browser: Child,
    to: File,
    from: BufReader<File>,
    session: Option<String>,
    sent: u64,
    _profile: tempfile::TempDir,
}

impl Tab {
    /// Opens a page.
    pub(crate) fn open(address: &str) -> Self {
        let profile = tempfile::tempdir().unwrap();
        let pipes = ["to", "from"].map(|name| profile.path().join(name));
        let made = Command::new("mkfifo").args(&pipes).status().unwrap();
        assert!(made.success());
        let [to, from] = &pipes;
        // Chromium reads commands from file descriptor 3 and writes to 4.
        let browser = Command::new("sh")
            .args(["-c", "exec chromium \"$@\" 3<\"$TO\" 4>\"$FROM\"", "chromium"])
            .args(["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run"])
            .args(["--disable-background-networking", "--disable-component-update"])
            .args(["--remote-debugging-pipe", "--window-size=1400,1000"])
            .arg(format!("--user-data-dir={}", profile.path().join("profile").display()))
            .env("TO", to)
            .env("FROM", from)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("this test opens a page in Chromium: run scripts/install-tools tests");
        let to = OpenOptions::new().write(true).open(to).unwrap();
        let from = BufReader::new(File::open(from).unwrap());
        let mut tab = Self { browser, to, from, session: None, sent: 0, _profile: profile };
        let targets = tab.call("Target.getTargets", json!({}));
        let targets = targets["targetInfos"].as_array().unwrap();
        let page = targets.iter().find(|target| target["type"] == "page").unwrap();
        let attach = json!({ "targetId": page["targetId"], "flatten": true });
        let attached = tab.call("Target.attachToTarget", attach);
        tab.session = Some(attached["sessionId"].as_str().unwrap().to_owned());
        tab.go(address);
        tab
    }

    /// Opens another page, or the same one again.
    pub(crate) fn go(&mut self, address: &str) {
        self.call("Page.navigate", json!({ "url": address }));
        // A drawing has no script that says so.
        self.wait("document.documentElement?.nodeName === 'svg' || document.documentElement?.dataset.ready === 'true'");
    }

    /// The result of a command of the protocol.
    pub(crate) fn call(&mut self, method: &str, parameters: Value) -> Value {
        self.sent += 1;
        let mut message = json!({ "id": self.sent, "method": method, "params": parameters });
        if let Some(session) = &self.session {
            message["sessionId"] = json!(session);
        }
        self.to.write_all(format!("{message}\0").as_bytes()).unwrap();
        loop {
            let mut answer = Vec::new();
            self.from.read_until(0, &mut answer).unwrap();
            answer.pop();
            let mut answer: Value = serde_json::from_slice(&answer).unwrap();
            if answer["id"] == self.sent {
                assert!(answer["error"].is_null(), "{method}: {answer}");
                return answer["result"].take();
            }
        }
    }

    /// The value of an expression in the page.
    pub(crate) fn value(&mut self, expression: &str) -> Value {
        let question =
            json!({ "expression": expression, "returnByValue": true, "awaitPromise": true });
        let mut answer = self.call("Runtime.evaluate", question);
        assert!(answer["exceptionDetails"].is_null(), "{expression}: {answer}");
        answer["result"]["value"].take()
    }

    /// Waits until an expression is true.
    pub(crate) fn wait(&mut self, expression: &str) {
        let begin = Instant::now();
        while self.value(expression) != json!(true) {
            let page = "document.body?.innerText";
            assert!(
                begin.elapsed() < PATIENCE,
                "waited in vain for {expression}: {}",
                self.value(page)
            );
            std::thread::sleep(Duration::from_millis(30));
        }
    }

    /// The middle of the element that a selector names (px).
    pub(crate) fn place(&mut self, selector: &str) -> [f64; 2] {
        let middle = format!(
            "(() => {{ const e = document.querySelector({selector:?}); e.scrollIntoView({{ block: 'center' }}); \
             const b = e.getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2]; }})()"
        );
        serde_json::from_value(self.value(&middle)).unwrap()
    }

    pub(crate) fn click(&mut self, selector: &str) {
        let at = self.place(selector);
        self.mouse("mousePressed", at);
        self.mouse("mouseReleased", at);
    }

    /// Presses the pointer at a place, moves it in steps and releases it.
    pub(crate) fn drag(&mut self, [x, y]: [f64; 2], [dx, dy]: [f64; 2]) {
        const STEPS: i32 = 20;
        self.mouse("mousePressed", [x, y]);
        for i in 1..=STEPS {
            let f = f64::from(i) / f64::from(STEPS);
            self.mouse("mouseMoved", [x + f * dx, y + f * dy]);
        }
        self.mouse("mouseReleased", [x + dx, y + dy]);
    }

    fn mouse(&mut self, kind: &str, [x, y]: [f64; 2]) {
        let buttons = u8::from(kind != "mouseReleased");
        let event = json!({ "type": kind, "x": x, "y": y, "button": "left", "buttons": buttons, "clickCount": 1 });
        self.call("Input.dispatchMouseEvent", event);
    }

    /// What the window shows, as a PNG.
    pub(crate) fn picture(&mut self) -> Vec<u8> {
        self.bytes("Page.captureScreenshot", json!({}))
    }

    /// The bytes that a command returns as base64.
    pub(crate) fn bytes(&mut self, method: &str, parameters: Value) -> Vec<u8> {
        let mut result = self.call(method, parameters);
        let text: String = serde_json::from_value(result["data"].take()).unwrap();
        base64::engine::general_purpose::STANDARD.decode(text).unwrap()
    }

    /// Makes the screen `dark` or `light`.
    pub(crate) fn prefer(&mut self, scheme: &str) {
        let feature = json!({ "name": "prefers-color-scheme", "value": scheme });
        self.call("Emulation.setEmulatedMedia", json!({ "features": [feature] }));
    }

    /// Drops a file onto an element.
    pub(crate) fn drop_file(&mut self, file: &str, selector: &str) {
        let [x, y] = self.place(selector);
        for kind in ["dragEnter", "dragOver", "drop"] {
            let data = json!({ "items": [], "files": [file], "dragOperationsMask": 1 });
            let event = json!({ "type": kind, "x": x, "y": y, "data": data });
            self.call("Input.dispatchDragEvent", event);
        }
    }

    pub(crate) fn press(&mut self, key: &str) {
        for kind in ["keyDown", "keyUp"] {
            self.call("Input.dispatchKeyEvent", json!({ "type": kind, "key": key }));
        }
    }
}

impl Drop for Tab {
    fn drop(&mut self) {
        let _ = self.browser.kill();
        let _ = self.browser.wait();
    }
}
