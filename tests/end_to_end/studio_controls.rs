//! The controls of `kirigami studio`: explained, named, legible and on the screen.

use crate::browser::Tab;
use crate::common::Workplace;
use crate::studio::{A4, Studio, at_rest, lists, opened, scene_on_disk};
use serde_json::json;

#[test]
fn every_control_is_explained_and_no_window_is_too_narrow() {
    let work = Workplace::new();
    let (_studio, mut tab) = opened(&work, A4);
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
    tab.wait(&lists("cut.dxf"));
    assert_eq!(widths(), first);
    // The cheapest level that is accurate enough for this sheet.
    tab.value("document.querySelector('[data-fields=search] .actions input').value = 1000");
    tab.value("[...document.querySelectorAll('button')].find((button) => button.textContent === 'Cheapest within').click()");
    tab.wait("scene.level === 'pin'");
}
