//! Scenes generated from the JSON schema: every key in its place, with values of its type, so that faults arise from combinations.

use serde_json::{Map, Value};

use crate::mutate::Numbers;

/// Tables within tables are left out from here on.
const DEEPEST: usize = 7;

/// Makes scenes of the schema of scene files, diagrams included.
pub struct Maker {
    pub schema: Value,
    pub numbers: Numbers,
}

impl Maker {
    pub fn new(seed: u64) -> Maker {
        Maker {
            schema: nullray::scene::schema(),
            numbers: Numbers::new(seed),
        }
    }

    /// A scene file: a line for each of its keys. Most have a camera, and then hardly more of what must be there too.
    pub fn scene(&mut self) -> String {
        let schema = self.schema.clone();
        let mut tables = self.table(&schema, 0);
        if !tables.contains_key("diagram") && !self.one_in(8) {
            let of = schema["properties"]["camera"].clone();
            let mut camera = self.value(&of, 1);
            if let Some(camera) = camera.as_object_mut() {
                camera.remove("node");
                camera.insert("eye".into(), vec![0.0, 0.0, 3.0].into());
                camera.insert("look_at".into(), vec![0.0, 0.0, 0.0].into());
            }
            tables.insert("camera".into(), camera);
        }
        let lines = tables
            .iter()
            .map(|(key, value)| format!("{key} = {}\n", toml(value)));
        lines.collect()
    }

    pub fn one_in(&mut self, n: usize) -> bool {
        self.numbers.below(n) == 0
    }

    pub fn pick(&mut self, all: &[Value]) -> Value {
        all[self.numbers.below(all.len())].clone()
    }

    /// The keys that are required, and some of the others.
    fn table(&mut self, schema: &Value, depth: usize) -> Map<String, Value> {
        let mut table = Map::new();
        let Some(properties) = schema["properties"].as_object() else {
            return table;
        };
        let required = schema["required"].as_array().cloned().unwrap_or_default();
        // Sparse, so that many agree with each other.
        let rarity = 2 + self.numbers.below(8);
        for (key, of) in properties {
            let is_required = required.iter().any(|name| name == key);
            if is_required || (depth < DEEPEST && self.one_in(rarity)) {
                table.insert(key.clone(), self.value(of, depth + 1));
            }
        }
        table
    }

    pub fn value(&mut self, schema: &Value, depth: usize) -> Value {
        if let Some(name) = schema["$ref"].as_str().and_then(|r| r.rsplit('/').next()) {
            let of = self.schema["$defs"][name].clone();
            return self.value(&of, depth);
        }
        if let Some(examples) = schema["examples"].as_array()
            && !examples.is_empty()
            && self.one_in(2)
        {
            return self.pick(examples);
        }
        for choice in ["anyOf", "oneOf"] {
            if let Some(all) = schema[choice].as_array() {
                let of = self.pick(all);
                return self.value(&of, depth);
            }
        }
        if let Some(all) = schema["enum"].as_array() {
            return self.pick(all);
        }
        if !schema["const"].is_null() {
            return schema["const"].clone();
        }
        match schema["type"].as_str() {
            Some("object") => self.table(schema, depth).into(),
            Some("array") => {
                let bound = |key: &str| schema[key].as_u64().map(|n| n as usize);
                let least = bound("minItems").unwrap_or(0);
                let most = bound("maxItems").unwrap_or(least + 3);
                let count = least + self.numbers.below(most - least + 1);
                let items = (0..count).map(|_| self.value(&schema["items"], depth + 1));
                items.collect::<Vec<_>>().into()
            }
            Some("boolean") => self.one_in(2).into(),
            Some("integer") => [0i64, 1, 2, 3, 7, 64, -1, 1 << 31][self.numbers.below(8)].into(),
            Some("number") => self.number().into(),
            _ => match schema["pattern"].as_str() {
                Some(pattern) => self.quantity(pattern).into(),
                None => self.name().into(),
            },
        }
    }

    pub fn number(&mut self) -> f64 {
        let rare = [1e-300, 1e300, -0.0, 1e16, 1e-9, 0.999_999_999_999];
        match self.numbers.below(12) {
            0 => rare[self.numbers.below(rare.len())],
            1..=3 => 0.0,
            4..=6 => [1.0, -1.0, 2.0, 0.5][self.numbers.below(4)],
            _ => (self.numbers.below(4001) as f64 - 2000.0) / 500.0,
        }
    }

    /// A name, of which there are few.
    fn name(&mut self) -> &'static str {
        const NAMES: [&str; 10] = [
            "a", "b", "S'", "world", "camera", "*x*_1", "a.glb", "a.npy", "", "{title}",
        ];
        NAMES[self.numbers.below(NAMES.len())]
    }

    /// A number and one of the units of the pattern, mostly: the last of its groups.
    fn quantity(&mut self, pattern: &str) -> String {
        const NUMBERS: [&str; 8] = ["1", "0", "-2", "0.5", "30", "500", "1e-9", "1e300"];
        const OTHERS: [&str; 4] = ["#aa3355", "1 m", "3 parsec", "1e300 %"];
        let group = pattern.rsplit_once('(').map(|(_, end)| end);
        let group = group.and_then(|end| end.split_once(')'));
        match group {
            Some((units, _)) if !self.one_in(16) => {
                let units: Vec<_> = units.split('|').collect();
                let number = NUMBERS[self.numbers.below(NUMBERS.len())];
                let unit = units[self.numbers.below(units.len())].replace('\\', "");
                format!("{number} {unit}")
            }
            _ => OTHERS[self.numbers.below(OTHERS.len())].into(),
        }
    }
}

/// The value in TOML, tables in one line.
pub fn toml(value: &Value) -> String {
    match value {
        Value::Object(table) => {
            let entries = table
                .iter()
                .map(|(key, value)| format!("{key:?} = {}", toml(value)));
            format!("{{ {} }}", entries.collect::<Vec<_>>().join(", "))
        }
        Value::Array(all) => format!("[{}]", all.iter().map(toml).collect::<Vec<_>>().join(", ")),
        Value::Number(number) if number.is_f64() => format!("{:?}", number.as_f64().unwrap()),
        Value::Null => "0".into(),
        value => value.to_string(),
    }
}
