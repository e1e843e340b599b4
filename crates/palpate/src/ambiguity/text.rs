//! The tree as text, in the manner of figure 3.9.

use std::fmt::Write;

use super::{AmbiguityTree, Answers, Node, Status, TreeMethod};
use crate::dimension::Dimension;
use crate::path::Path;

impl<V: Dimension> AmbiguityTree<V> {
    /// Drawn with one line for each branch: `S1`, `S2` are what may be sensed, `I1`, `I2` the hypotheses.
    #[must_use]
    pub fn to_text(&self) -> String {
        let mut text = self.heading();
        text += &self.described(self.root());
        text.push('\n');
        self.draw(0, "", &mut text);
        text
    }

    fn heading(&self) -> String {
        let n = self.names.len();
        let many = if n == 1 { "hypothesis" } else { "hypotheses" };
        let how = match self.method {
            TreeMethod::Greedy => "greedy",
            TreeMethod::Ahead => "looking ahead",
            TreeMethod::Optimal => "optimal over the paths found",
        };
        let mut text = format!("{n} {many}, {how}\n");
        let _ = writeln!(
            text,
            "touches: {:.2} expected, {} worst; with {} outcomes at least {:.2} and {}",
            self.expected_touches,
            self.worst_touches,
            self.max_outcomes,
            self.entropy_bound,
            self.worst_bound
        );
        text
    }

    /// The branches of a node, one below the other.
    fn draw(&self, number: usize, indent: &str, text: &mut String) {
        let node = &self.nodes[number];
        let last = node.branches.len().saturating_sub(1);
        for (k, branch) in node.branches.iter().enumerate() {
            let (corner, stem) = if k == last { ("└─ ", "   ") } else { ("├─ ", "│  ") };
            let Some(next) = branch.node else {
                let _ = writeln!(text, "{indent}{corner}unexpected: recognize again");
                continue;
            };
            let answers = match branch.answers {
                Answers::Contact => "contact",
                Answers::NoContact => "no contact",
                Answers::Either => "contact or none",
                Answers::Unexpected => "unexpected",
            };
            let _ =
                writeln!(text, "{indent}{corner}S{} {answers}: {}", k + 1, self.described(&self.nodes[next]));
            self.draw(next, &format!("{indent}{stem}"), text);
        }
    }

    /// Who is left, and how to go on.
    fn described(&self, node: &Node<V>) -> String {
        let name = |member: &usize| format!("I{} {}", member + 1, self.names[*member]);
        let members = node.members.iter().map(name).collect::<Vec<_>>().join(", ");
        let more = node.members.len() - 1;
        match node.status {
            Status::Solved => members,
            Status::Divided => {
                format!("{members} | {}", node.path.as_ref().map(described).unwrap_or_default())
            }
            Status::Inseparable => format!("{members} | inseparable, counts {more}"),
            Status::NoUsablePath => format!("{members} | no usable path, counts {more}"),
            Status::Effort => format!("{members} | search cut short, counts {more}"),
            Status::Unexpanded => format!("{members} | not planned for, counts {more}"),
        }
    }
}

fn described<V: Dimension>(path: &Path<V>) -> String {
    let rounded = |vector: V| {
        let coordinates: Vec<String> = vector.coordinates().iter().map(|one| format!("{one:.2}")).collect();
        format!("({})", coordinates.join(", "))
    };
    let direction = path.line.direction;
    let way = match direction.angle() {
        Some(angle) => format!("at {:.2}°", angle.to_degrees()),
        None => format!("along {}", rounded(direction)),
    };
    format!("path from {} {way}, margin {:.3}", rounded(path.line.start), path.margin)
}
