//! Any bytes give whole frames in order of lambda, or a typed error.
#![no_main]

use fe_driver::{Layout, read_dat};
use libfuzzer_sys::fuzz_target;

const LAYOUT: Layout = Layout {
    nodes: 1000,
    arc_nodes: 2,
    displaced_nodes: 1,
    elements: 1,
    points: 8,
};

fuzz_target!(|bytes: &[u8]| {
    if let Ok(frames) = read_dat(bytes, LAYOUT) {
        assert!(frames.windows(2).all(|pair| pair[0].lambda < pair[1].lambda));
        for frame in frames {
            assert_eq!(frame.reactions.len(), LAYOUT.arc_nodes);
            assert_eq!(frame.peeq.len(), 8 * LAYOUT.elements);
            assert!(frame.stress.iter().flatten().all(|stress| stress.is_finite()));
        }
    }
});
