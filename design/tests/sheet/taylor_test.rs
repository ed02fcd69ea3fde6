//! The Taylor test itself.

use crate::prelude::*;
use std::convert::Infallible;

fn orders(gradient: [f64; 2]) -> Vec<f64> {
    let f = |x: &[f64]| Ok::<_, Infallible>(x[0].sin() * x[1].exp());
    TaylorRemainders::new(f, &[0.3, 0.7], &gradient, &[0.8, -0.6], 1e-3, 4).unwrap().orders()
}

#[test]
fn an_exact_gradient_shows_order_two_and_a_wrong_one_order_one() {
    let exact = [0.3_f64.cos() * 0.7_f64.exp(), 0.3_f64.sin() * 0.7_f64.exp()];
    assert!(orders(exact).iter().all(|order| (order - 2.0).abs() < 0.02));
    let wrong = [exact[0], 1.1 * exact[1]];
    assert!(orders(wrong).iter().all(|order| *order < 1.2));
}
