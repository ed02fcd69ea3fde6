//! `kirigami surrogate`: the card of exported weights, and their errors.

mod card;
mod test;
mod visited;

subcommands! {
    /// Show the card of exported weights, and measure their errors against finite elements
    pub(crate) enum SurrogateCommand {
        Card(card::CardCommand),
        Test(test::TestCommand),
        Visited(visited::VisitedCommand),
    }
}
