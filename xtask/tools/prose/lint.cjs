// Lints the prose of the files named on standard input, one a line, with textlint. Prints a line for each hit:
// path:line, rule, text, suggestion, with tabs between them.
"use strict";
const fs = require("fs");
const path = require("path");
const { TextlintKernel } = require("@textlint/kernel");
const { parse } = require("@textlint/markdown-to-ast");
const prh = require("textlint-rule-prh").default;
const { split } = require("sentence-splitter");
const yaml = require("js-yaml");

const WORDS_MAX = 35;
const FIGURES_MAX = 2;

// Tokens of a source that may hold prose, and strings that only look like it.
const RUST = /\/\/[^\n]*|\/\*[^]*?\*\/|\bb?c?r(#*)"[^]*?"\1|"(?:\\[^]|[^"\\])*"|'(?:\\.[^']*|[^'\\\n])'/g;
const PYTHON = /#[^\n]*|("""|''')[^]*?\1|"(?:\\[^]|[^"\\\n])*"|'(?:\\[^]|[^'\\\n])*'/g;

// The prose of a source as Markdown, on the lines where it is, and the lines where doc comments begin. A text beside code
// becomes a heading, which no other line continues.
function extract(source, file) {
  const isRust = file.endsWith(".rs");
  const lines = source.split("\n").map(() => "");
  const starts = new Set();
  const isTest = /(^|\/)(tests?|benches)(\/|\.rs$)/.test(file);
  const testsAt = isTest ? 0 : (source.search(/^#\[cfg\(test\)\]\n(pub(\(crate\))? )?mod \w+ \{/m) + 1 || Infinity) - 1;
  let line = 0;
  let end = 0;
  let docEnds = -2;
  for (const token of source.matchAll(isRust ? RUST : PYTHON)) {
    line += source.slice(end, token.index).split("\n").length - 1;
    const text = token[0];
    const isAlone = /(^|\n)[ \t]*$/.test(source.slice(Math.max(0, token.index - 200), token.index));
    const comment = text.match(isRust ? /^\/\/(\/(?!\/)|!)? ?/ : /^#:? ?/);
    if (comment) {
      const content = text.slice(comment[0].length);
      if (isAlone) lines[line] = content;
      else lines[line] += `# ${content.trim()}. `;
      if (comment[1]) {
        if (docEnds !== line - 1) starts.add(line + 1);
        docEnds = line;
      }
    } else if (!isRust && token[1] && isAlone) {
      const content = text.slice(3, -3).split("\n");
      const indent = Math.min(...content.slice(1).filter((it) => it.trim()).map((it) => it.search(/\S/)));
      content.forEach((it, at) => (lines[line + at] = /^\s*>>>|^\s*\.\.\. /.test(it) ? "" : at ? it.slice(indent) : it));
      starts.add(line + 1 + (content[0].trim() ? 0 : 1));
    } else if (isRust && text.startsWith('"') && token.index < testsAt) {
      const content = text.slice(1, -1).replace(/\\\n\s*/g, "").replace(/(\\n|\n)\s+/g, ". ").replace(/\\n|\n/g, " ").replace(/\\(.)/g, "$1");
      const prose = content.replace(/\{[^{}]*\}/g, "`x`");
      if (/[A-Za-z]+,? [a-z]+,? [a-z]+/.test(prose.replaceAll("`", "")) && !/[<;=|]|^libfranka/.test(prose)) lines[line] += `# ${prose.trim()}. `;
    }
    end = token.index;
  }
  // Without runs of empty lines, which take the parser long.
  const kept = lines.map((text, at) => ({ text, line: at + 1 })).filter(({ text }, at) => text.trim() || (lines[at - 1] || "").trim());
  return { text: kept.map((it) => it.text).join("\n"), starts, numbers: kept.map((it) => it.line) };
}

class Sources {
  availableExtensions() {
    return [".rs", ".py", ".pyi", ".md"];
  }
  processor(extension) {
    const number = (line) => (this.numbers ? this.numbers[line - 1] : line);
    return {
      preProcess: (source, file) => {
        const extracted = extension === ".md" ? { text: source, starts: new Set() } : extract(source, file);
        this.numbers = extracted.numbers;
        const ast = parse(extracted.text);
        ast.children = ast.children.filter((node) => node.type !== "Table");
        for (const node of ast.children) node.isDocStart = node.type === "Paragraph" && extracted.starts.has(number(node.loc.start.line));
        return { text: extracted.text, ast };
      },
      postProcess: (messages, filePath) => ({
        messages: messages.map((it) => ({ ...it, line: number(it.line) })),
        filePath,
      }),
    };
  }
}

// The text of a node: markup as blanks, code as one word without figures, at the same places.
function plain(node, source) {
  const text = source.split("").map(() => " ");
  const walk = (child) => {
    const [from, to] = child.range.map((at) => at - node.range[0]);
    if (child.type === "Str") for (let at = from; at < to; at++) text[at] = source[at];
    else if (["Code", "Image", "Html"].includes(child.type)) text.fill("c", from, to);
    else (child.children || []).forEach(walk);
  };
  walk(node);
  return text.join("");
}

function sentences(context) {
  const check = (node) => {
    const text = plain(node, context.getSource(node));
    const report = (index, text, suggestion, rule) =>
      context.report(node, new context.RuleError([text, suggestion, rule].join("\t"), { index }));
    const start = node.isDocStart && text.match(/^\s*(What|Which|Whether|With what|Of|Until|Where|How|Why|When)\b/);
    if (start) report(0, start[1], "begin with the noun or the verb", "doc-start");
    const isTitle = node.type === "Header" && context.getFilePath().endsWith(".md");
    for (const { index, 0: clause } of start || isTitle ? [] : text.matchAll(/(?<=^\s*|[.!]\s+)(?:\w+ )?[Ww]hat\s(?!follows)[^.?!]*[.!:]/g)) {
      if (/^([Ww]hat|With|Of|From|To|In|For|By|On)/.test(clause)) report(index, clause.slice(0, 40), "the noun as subject", "what-first");
    }
    if (count(text, WORD) <= WORDS_MAX && count(text, FIGURE) <= FIGURES_MAX) return;
    for (const { range, raw } of split(text).filter((it) => it.type === "Sentence")) {
      const words = raw.match(WORD) || [];
      const figures = raw.match(FIGURE) || [];
      if (words.length > WORDS_MAX) report(range[0], `${words.slice(0, 4).join(" ")} ...`, `${words.length} words: split it`, "length");
      if (figures.length > FIGURES_MAX) report(range[0], figures.join(" "), "a table, or a sentence each", "figures");
    }
  };
  return { [context.Syntax.Paragraph]: check, [context.Syntax.Header]: check };
}

const count = (text, pattern) => (text.match(pattern) || []).length;
const WORD = /[\p{L}\p{N}]\S*/gu;
// A number; not an address, a version of three parts, a date, or part of a name.
const FIGURE = /(?<![\p{L}\p{N}_.,:/-])(?!\d+(\.\d+){2,}|\d{4}-\d)\d+(?:[.,:]\d+| \d{3}\b)*/gu;

const read = (name) => fs.readFileSync(path.join(__dirname, name), "utf8");
const kernel = new TextlintKernel();
const everywhere = Object.fromEntries(["Link", "BlockQuote", "Emphasis", "Header", "Paragraph"].map((it) => [`check${it}`, true]));
const rules = [
  { ruleId: "words", rule: prh, options: { ...everywhere, ruleContents: [read("words.yml")] } },
  { ruleId: "sentences", rule: sentences },
];
const plugins = [{ pluginId: "sources", plugin: { Processor: Sources } }];
const allowed = yaml.safeLoad(read("allow.yml")).map((it) => ({ file: it.file, text: new RegExp(it.text) }));

async function lint(source, file) {
  const lines = source.split("\n");
  const { messages } = await kernel.lintText(source, { filePath: file, ext: path.extname(file), plugins, rules });
  const hits = messages.map(({ line, message, ruleId }) => {
    // Messages of prh: text, suggestion and, in the next line, the name of the rule.
    const [text, suggestion, rule] = message.split(ruleId === "words" ? / => |\n(?=[\w-]+$)/ : "\t");
    if (!rule) throw new Error(`${file}:${line}: ${message}`);
    return { line, rule, text: text.replace(/\s+/g, " "), suggestion };
  });
  return hits.filter(({ line }) => !allowed.some((it) => file.startsWith(it.file) && it.text.test(lines[line - 1])));
}

// Fails unless each rule finds its example, and nothing else does.
async function checkExamples() {
  const examples = yaml.safeLoad(read("examples.yml"));
  const names = [...read("words.yml").matchAll(/prh: ([\w-]+)/g)].map((it) => it[1]).concat("doc-start", "what-first", "length", "figures");
  for (const name of names) if (!examples.some((it) => it.rule === name)) throw new Error(`${name} has no example`);
  for (const { rule, file, bad, good } of examples) {
    const found = async (text) => {
      const hits = await (file ? lint(text, file) : lint(`/// ${text}\nfn f() {}\n`, "example.rs"));
      return hits.map((it) => it.rule).join();
    };
    const [inBad, inGood] = [await found(bad), await found(good)];
    if (inBad !== rule || inGood) throw new Error(`the example of ${rule}: got ${inBad}; ${inGood || "nothing"}`);
  }
}

async function main() {
  await checkExamples();
  for (const file of fs.readFileSync(0, "utf8").split("\n").filter(Boolean)) {
    for (const { line, rule, text, suggestion } of await lint(fs.readFileSync(file, "utf8"), file)) {
      console.log([`${file}:${line}`, rule, text, suggestion].join("\t"));
    }
  }
}

main().catch((error) => {
  console.error(error.message);
  process.exitCode = 1;
});
