// SPDX-License-Identifier: Apache-2.0
// Prints the places of TypeScript files at which a mutant can be made, as JSON: [{path, line, begin, end, kind, replacement, form}], in bytes.
//   node find.mjs TOP PATH...      the current folder has the node_modules of clients/web and its tsconfig.json
import path from 'node:path';
import ts from 'typescript';

const kind = ts.SyntaxKind;
const opposites = new Map([
  [kind.AmpersandAmpersandToken, ['condition', '||']], [kind.BarBarToken, ['condition', '&&']],
  [kind.LessThanToken, ['comparison', '<=', '>=']], [kind.LessThanEqualsToken, ['comparison', '<', '>']],
  [kind.GreaterThanToken, ['comparison', '>=', '<=']], [kind.GreaterThanEqualsToken, ['comparison', '>', '<']],
  [kind.EqualsEqualsEqualsToken, ['comparison', '!==']], [kind.ExclamationEqualsEqualsToken, ['comparison', '===']],
  [kind.PlusToken, ['arithmetic', '-']], [kind.MinusToken, ['arithmetic', '+']], [kind.AsteriskToken, ['arithmetic', '/']],
  [kind.SlashToken, ['arithmetic', '*']], [kind.PercentToken, ['arithmetic', '*']],
  [kind.AmpersandToken, ['arithmetic', '|']], [kind.BarToken, ['arithmetic', '&']],
  [kind.PlusEqualsToken, ['arithmetic', '-=']], [kind.MinusEqualsToken, ['arithmetic', '+=']],
]);

const [top, ...paths] = process.argv.slice(2);
const { config } = ts.readConfigFile(path.join(process.cwd(), 'tsconfig.json'), ts.sys.readFile);
const { options } = ts.parseJsonConfigFileContent(config, ts.sys, process.cwd());
const program = ts.createProgram(paths.map((name) => path.join(top, name)), options);
const checker = program.getTypeChecker();
const found = [];

for (const name of paths) {
  const file = program.getSourceFile(path.join(top, name));
  const source = (node) => node.getText(file);
  const bytes = (position) => Buffer.byteLength(file.text.slice(0, position));
  const isNumber = (node) => (checker.getTypeAtLocation(node).flags & (ts.TypeFlags.NumberLike | ts.TypeFlags.BigIntLike)) !== 0;
  const isBoolean = (node) => (checker.getTypeAtLocation(node).flags & ts.TypeFlags.BooleanLike) !== 0;
  const isComparison = (node) => ts.isBinaryExpression(node) && opposites.get(node.operatorToken.kind)?.[0] === 'comparison';

  const add = (node, what, replacement, form = 'expression') =>
    found.push({ path: name, line: file.getLineAndCharacterOfPosition(node.getStart(file)).line + 1, kind: what, replacement, form,
      begin: bytes(node.getStart(file)), end: bytes(node.end) });

  /** The opposite of a condition, unless that is a place of its own. */
  const turn = (node) => {
    if (!isComparison(node) && !ts.isPrefixUnaryExpression(node) && node.kind !== kind.TrueKeyword && node.kind !== kind.FalseKeyword) {
      add(node, 'condition', `!(${source(node)})`);
    }
  };
  const leaves = (body) => (ts.isBlock(body) ? body.statements.length > 0 && leaves(body.statements.at(-1))
    : ts.isReturnStatement(body) || ts.isContinueStatement(body) || ts.isBreakStatement(body) || ts.isThrowStatement(body));

  const visit = (node) => {
    if (ts.isTypeNode(node) || ts.isImportDeclaration(node) || ts.isEnumDeclaration(node) || ts.isJsxAttribute(node) && /^class/.test(source(node))
      || ts.isCallExpression(node) && source(node).startsWith('console.')) return;
    if (ts.isIfStatement(node)) {
      turn(node.expression);
      if (leaves(node.thenStatement)) add(node.expression, 'error check', 'false');
    } else if (ts.isConditionalExpression(node)) {
      turn(node.condition);
    } else if (ts.isReturnStatement(node) && node.expression && isBoolean(node.expression)) {
      turn(node.expression);
    } else if (ts.isArrowFunction(node) && !ts.isBlock(node.body) && isBoolean(node.body)) {
      turn(node.body);
    } else if (ts.isBinaryExpression(node)) {
      const [what, ...others] = opposites.get(node.operatorToken.kind) ?? [];
      if (what !== 'arithmetic' || (isNumber(node.left) && isNumber(node.right))) {
        for (const other of others) add(node, what, `${source(node.left)} ${other} ${source(node.right)}`);
      }
    } else if (ts.isPrefixUnaryExpression(node) && node.operator === kind.ExclamationToken) {
      add(node, 'condition', `!!(${source(node.operand)})`);
    } else if (ts.isPrefixUnaryExpression(node) && node.operator === kind.MinusToken) {
      add(node, 'sign', `(${source(node.operand)})`);
    } else if (ts.isNumericLiteral(node) && node.parent.name !== node) {
      const value = Number(node.text);
      if (!Number.isInteger(value)) add(node, 'constant', `${source(node)} * 1.25`);
      else for (const other of value === 0 ? ['+ 1'] : ['+ 1', '- 1']) add(node, 'constant', `${source(node)} ${other}`);
    } else if (node.kind === kind.TrueKeyword || node.kind === kind.FalseKeyword) {
      add(node, 'constant', node.kind === kind.TrueKeyword ? 'false' : 'true');
    } else if (ts.isExpressionStatement(node) && !source(node).startsWith('super(') && !source(node).startsWith('console.')) {
      add(node, 'statement', '', 'statement');
    }
    ts.forEachChild(node, visit);
  };
  visit(file);
}
process.stdout.write(JSON.stringify(found));
