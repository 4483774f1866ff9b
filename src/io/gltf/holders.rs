//! Nodes that hold a camera or a light, by name.

use super::document::{Document, listed, shortened};
use super::nodes::{Hierarchy, is_named, name_of, named};
use crate::Result;

/// What nodes may hold.
pub(super) struct Held {
    /// Like "camera".
    pub noun: &'static str,
    /// What to do about a file without any.
    pub otherwise: &'static str,
    /// The own name of what the node of this index holds, or ""; `None` if it holds none.
    pub of: for<'d> fn(&'d Document, usize) -> Option<&'d str>,
}

/// The names by which those of `nodes` can be found: those of their nodes, or else their own, or else the numbers of the nodes.
pub(super) fn names(
    document: &Document,
    nodes: impl Iterator<Item = usize>,
    held: &Held,
) -> Vec<String> {
    let name = |node: usize| {
        let own = (held.of)(document, node)?;
        let of_node = document.root.nodes.get(node)?.name.as_deref();
        let mut names = [of_node.unwrap_or_default(), own].into_iter();
        let name = names.find(|name| !name.is_empty()).map(shortened);
        Some(name.unwrap_or_else(|| name_of(document, node)))
    };
    nodes.filter_map(name).collect()
}

/// The only node that holds one of this name: the name of a node, of a node above the only one, or its own. Without a name, the only one of
/// the file.
pub(super) fn find(
    document: &Document,
    hierarchy: &Hierarchy,
    name: Option<&str>,
    held: &Held,
) -> Result<usize> {
    match candidates(document, hierarchy, name, held)?.as_slice() {
        &[node] => Ok(node),
        several => Err(not_one(document, name, several.len(), held)),
    }
}

fn candidates(
    document: &Document,
    hierarchy: &Hierarchy,
    name: Option<&str>,
    held: &Held,
) -> Result<Vec<usize>> {
    let nodes = 0..document.root.nodes.len();
    let all = nodes
        .clone()
        .filter(|&node| (held.of)(document, node).is_some());
    let Some(name) = name else {
        return Ok(all.collect());
    };
    let is_called =
        |&node: &usize| is_named(document, node, name) || (held.of)(document, node) == Some(name);
    let called: Vec<usize> = all.filter(is_called).collect();
    if called.is_empty() && nodes.into_iter().any(|node| is_named(document, node, name)) {
        // Some exporters put cameras and lights below the node that has their name.
        let below = hierarchy.with_all_below(vec![named(document, name)?], &mut |_| true);
        let below = below.iter().map(|placed| placed.node);
        return Ok(below
            .filter(|&node| (held.of)(document, node).is_some())
            .collect());
    }
    Ok(called)
}

fn not_one(document: &Document, name: Option<&str>, count: usize, held: &Held) -> crate::Error {
    let noun = held.noun;
    let place = match name {
        Some(name) => format!("{noun} {:?}", shortened(name)),
        None => format!("{noun}s"),
    };
    let what = match (count, name) {
        (0, Some(_)) => {
            format!("there is no {noun} of this name, nor a node of this name with one")
        }
        (0, None) => format!("no node of the file has a {noun}"),
        (n, _) => format!("there are {n} {noun}s to choose from"),
    };
    let names = names(document, 0..document.root.nodes.len(), held);
    let help = match names.is_empty() {
        true => held.otherwise.to_owned(),
        false => format!("name one of: {}", listed(names.iter().map(String::as_str))),
    };
    document.invalid(place, what, help)
}
