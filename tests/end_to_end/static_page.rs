//! The studio as a page without a server, from the folder that `make page` makes.

use crate::browser::Tab;
use serde_json::json;
use std::io::{BufRead, BufReader, Write};
use std::net::TcpListener;
use std::path::Path;
use std::sync::{Arc, Mutex};

/// Request lines, and the bytes of their answers.
type Asked = Arc<Mutex<Vec<(String, usize)>>>;

/// Serves a folder; returns the address and the list of what was asked for.
fn serve(folder: &'static str) -> (String, Asked) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = format!("http://{}/", listener.local_addr().unwrap());
    let asked = Asked::default();
    let list = Arc::clone(&asked);
    std::thread::spawn(move || {
        for stream in listener.incoming() {
            let mut stream = stream.unwrap();
            let mut lines = BufReader::new(&stream).lines().map_while(Result::ok);
            let Some(line) = lines.next() else { continue };
            lines.take_while(|line| !line.is_empty()).for_each(drop);
            let name = line.split(' ').nth(1).unwrap().trim_start_matches('/');
            let name = if name.is_empty() { "index.html" } else { name };
            let kind = match name.rsplit('.').next() {
                Some("html") => "text/html",
                Some("js") => "text/javascript",
                Some("wasm") => "application/wasm",
                _ => "application/octet-stream",
            };
            let root = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
            let (status, body) = match std::fs::read(root.join(name)) {
                Ok(body) => (200, body),
                Err(_) => (404, Vec::new()),
            };
            list.lock().unwrap().push((line.clone(), body.len()));
            let head = format!(
                "HTTP/1.1 {status} \r\nContent-Type: {kind}\r\nContent-Length: {}\r\nConnection: close\r\n\r\n",
                body.len()
            );
            // A browser that has ended reads no answer.
            let _ = stream.write_all(head.as_bytes()).and_then(|()| stream.write_all(&body));
        }
    });
    (address, asked)
}

#[test]
#[ignore = "needs the folder that `make page` makes, which runs this test"]
fn a_silhouette_becomes_a_cut_file_and_nothing_is_sent() {
    let (address, asked) = serve("target/page");
    let mut tab = Tab::open(&address);
    tab.wait("document.getElementById('new-says').textContent.includes('W within')");
    let folder = tempfile::tempdir().unwrap();
    let nothing = folder.path().join("nothing.svg");
    std::fs::write(&nothing, "<svg xmlns='http://www.w3.org/2000/svg'/>").unwrap();
    tab.drop_file(nothing.to_str().unwrap(), "#studio");
    tab.wait("document.getElementById('refusal').textContent.includes('nothing.svg')");
    let leaf = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs/targets/leaf.svg");
    tab.drop_file(leaf.to_str().unwrap(), "#studio");
    tab.wait("document.getElementById('fit').textContent.includes('of the target (common area')");
    tab.wait("document.documentElement.dataset.working === ''");
    // What a person waits for: page, program and the weights of one material.
    let loaded: usize = asked.lock().unwrap().iter().map(|(_, size)| size).sum();
    assert!(loaded < 12_000_000, "{loaded}");
    tab.click("#design");
    tab.wait("document.getElementById('left').textContent.includes('best so far')");
    // A search pauses, although the worker hears nothing, and goes on.
    tab.click("#design");
    tab.wait("document.documentElement.dataset.working === ''");
    let cut = "document.querySelector('#files a[download$=\"cut.dxf\"]').href";
    let text = format!("fetch({cut}).then((answer) => answer.text())");
    let file = tab.value(&text);
    assert!(file.as_str().unwrap().trim_end().ends_with("EOF"));
    assert_eq!(tab.value("document.getElementById('offline').hidden"), json!(true));
    let asked = asked.lock().unwrap();
    let sent = |(line, _): &&(String, usize)| !line.starts_with("GET ") || line.contains('?');
    assert_eq!(asked.iter().find(sent), None);
}
