//! Nodes and what is connected to them.

use super::values::value;
use crate::layers::layer::{Fields, Layer, PROPERTY_BYTES, Property};
use crate::layers::list_op::ListOp;
use crate::layers::value::{Text, Value};
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_import::bytes::xml::Xml;
use roxmltree::Node;
use std::collections::HashMap;

/// A layer while the materials of a document are added to it.
pub(super) struct Nodes<'d> {
    pub(super) layer: Layer<'static>,
    pub(super) xml: &'d Xml<'d>,
    /// The outermost elements.
    top: Named<'d>,
    /// Elements of graphs, by the place of the graph.
    inner: HashMap<usize, Named<'d>>,
}

/// Elements by their names, and whether they are outputs.
type Named<'d> = HashMap<(&'d str, bool), Node<'d, 'd>>;

/// A node in a graph, or outside of all.
#[derive(Clone, Copy)]
struct Placed<'d> {
    element: Node<'d, 'd>,
    graph: Option<Node<'d, 'd>>,
}

/// A material while it is read.
struct Material<'d> {
    prim: u32,
    path: String,
    /// Shaders by their names.
    made: HashMap<String, u32>,
    /// Shaders whose inputs are still to be read.
    waiting: Vec<(u32, Placed<'d>)>,
}

fn named<'d>(parent: Node<'d, 'd>) -> Named<'d> {
    let elements = parent.children().filter(Node::is_element);
    elements
        .filter_map(|element| Some(((element.attribute("name")?, element.has_tag_name("output")), element)))
        .collect()
}

/// References of inputs of graphs to inputs of graphs.
const MAX_CHAIN: usize = 16;

impl<'d> Nodes<'d> {
    pub(super) fn new(layer: Layer<'static>, xml: &'d Xml<'d>) -> Nodes<'d> {
        let inner = xml.root().children().filter(|element| element.has_tag_name("nodegraph"));
        let inner = inner.map(|graph| (graph.range().start, named(graph))).collect();
        Nodes { layer, xml, top: named(xml.root()), inner }
    }

    /// Adds the surface of a material and all that it uses.
    pub(super) fn material(
        &mut self,
        prim: u32,
        path: &str,
        element: Node<'d, 'd>,
        budget: &mut Budget,
    ) -> Result<(), FormatError> {
        let mut material =
            Material { prim, path: path.to_owned(), made: HashMap::new(), waiting: Vec::new() };
        let placed = Placed { element, graph: None };
        for input in element.children().filter(Node::is_element) {
            let target = match input.tag_name().name() {
                "input" if input.attribute("name") == Some("surfaceshader") => {
                    self.source(&mut material, input, placed, budget)?
                }
                // Before version 1.38.
                "shaderref" => {
                    let placed = Placed { element: input, graph: None };
                    Some(self.shader(&mut material, placed, "out", budget)?)
                }
                _ => None,
            };
            if let Some(target) = target {
                self.property(prim, "outputs:mtlx:surface", None, Some(target), budget)?;
            }
        }
        while let Some((shader, placed)) = material.waiting.pop() {
            self.inputs(&mut material, shader, placed, budget)?;
        }
        Ok(())
    }

    /// Adds the inputs of a shader.
    fn inputs(
        &mut self,
        material: &mut Material<'d>,
        shader: u32,
        placed: Placed<'d>,
        budget: &mut Budget,
    ) -> Result<(), FormatError> {
        for input in placed.element.children().filter(Node::is_element) {
            let is_input =
                matches!(input.tag_name().name(), "input" | "parameter" | "bindinput" | "bindparam");
            let Some(name) = input.attribute("name").filter(|_| is_input) else { continue };
            let name = format!("inputs:{name}");
            if let Some(target) = self.source(material, input, placed, budget)? {
                self.property(shader, &name, None, Some(target), budget)?;
                continue;
            }
            let stated = outer(input, placed.graph).unwrap_or(input);
            let kind = stated.attribute("type").unwrap_or("string");
            let prefix = if kind == "filename" { prefix(stated) } else { String::new() };
            let text = stated.attribute("value").map(|text| format!("{prefix}{text}"));
            if let Some(value) = text.and_then(|text| value(kind, &text)) {
                self.property(shader, &name, Some((value, stated.attribute("colorspace"))), None, budget)?;
            }
        }
        Ok(())
    }

    /// The output that is connected to an input, as a path.
    fn source(
        &mut self,
        material: &mut Material<'d>,
        input: Node<'d, 'd>,
        placed: Placed<'d>,
        budget: &mut Budget,
    ) -> Result<Option<Text>, FormatError> {
        let (mut input, mut graph) = (input, placed.graph);
        for _ in 0..MAX_CHAIN {
            if let Some(stated) = outer(input, graph) {
                (input, graph) = (stated, None);
            }
            let output = input.attribute("output");
            let inside = |graph: Option<Node<'d, 'd>>, name: &'d str, is_output: bool| match graph {
                Some(graph) => self.inner.get(&graph.range().start)?.get(&(name, is_output)).copied(),
                None => self.top.get(&(name, is_output)).copied(),
            };
            if let Some(name) = input.attribute("nodegraph") {
                let Some(of) = self.top.get(&(name, false)).copied() else { return Ok(None) };
                let only = || of.children().find(|element| element.has_tag_name("output"));
                let found = output.and_then(|output| inside(Some(of), output, true)).or_else(only);
                let Some(found) = found else { return Ok(None) };
                (input, graph) = (found, Some(of));
                continue;
            }
            let Some(name) = input.attribute("nodename") else { return Ok(None) };
            let Some(element) = inside(graph, name, false) else { return Ok(None) };
            let placed = Placed { element, graph };
            return self.shader(material, placed, output.unwrap_or("out"), budget).map(Some);
        }
        Ok(None)
    }

    /// The path of an output of a node, which is added if it is new.
    fn shader(
        &mut self,
        material: &mut Material<'d>,
        placed: Placed<'d>,
        output: &str,
        budget: &mut Budget,
    ) -> Result<Text, FormatError> {
        let element = placed.element;
        let graph = placed.graph.and_then(|graph| graph.attribute("name"));
        let graph = graph.map_or_else(String::new, |graph| format!("{graph}_"));
        let name = format!("{graph}{}", element.attribute("name").unwrap_or("surface"));
        if !material.made.contains_key(&name) {
            let prim = self.prim(material.prim, &name, "Shader", element, budget)?;
            material.made.insert(name.clone(), prim);
            material.waiting.push((prim, placed));
            let tag = element.tag_name().name();
            let category = if tag == "shaderref" { element.attribute("node").unwrap_or(tag) } else { tag };
            let kind = element.attribute("type").unwrap_or("surfaceshader");
            let id =
                element.attribute("nodedef").map_or_else(|| format!("ND_{category}_{kind}"), str::to_owned);
            self.property(prim, "info:id", Some((Value::Text(id.into()), None)), None, budget)?;
        }
        Ok(format!("{}/{name}.outputs:{output}", material.path).into())
    }

    fn property(
        &mut self,
        prim: u32,
        name: &str,
        value: Option<(Value, Option<&str>)>,
        target: Option<Text>,
        budget: &mut Budget,
    ) -> Result<(), FormatError> {
        budget.take_bytes(PROPERTY_BYTES + name.len() as u64, &self.layer.name)?;
        let (value, space) = value.map_or((None, None), |(value, space)| (Some(value), space));
        let space = space.map(|space| ("colorSpace".into(), Value::Text(space.into())));
        let targets = target.map(|target| ListOp::explicit(vec![target]));
        let fields = Fields(space.into_iter().collect());
        let property = Property { name: name.into(), value, targets, fields, ..Property::default() };
        self.layer.prims[prim as usize].properties.push(property);
        Ok(())
    }
}

/// The input of a graph that an input in it stands for.
fn outer<'d>(input: Node<'d, 'd>, graph: Option<Node<'d, 'd>>) -> Option<Node<'d, 'd>> {
    let name = input.attribute("interfacename")?;
    let named = |element: &Node| element.has_tag_name("input") && element.attribute("name") == Some(name);
    graph?.children().find(named)
}

/// Prefix of names of files: the prefixes of all elements around them, the outermost first.
fn prefix(input: Node) -> String {
    let mut all: Vec<&str> =
        input.ancestors().filter_map(|element| element.attribute("fileprefix")).collect();
    all.reverse();
    all.concat()
}
