/**
 * Scoped names, `model::link`, and the one rule that splits them (as Python's
 * `description/scoped_names.py`; both are tested with test/data/scoped_names.json).
 */

/** Between the name of a model and that of what belongs to it. */
const SCOPE = '::';

/**
 * The model that a name begins with, and the rest of the name within it. The longest name of an
 * existing model wins: links of nested models have scoped names of their own.
 * @param name  `model`, `model::link`, `model::link::collision`, or a plain name
 * @param isModel  whether a model has this name
 * @returns model and rest; rest is '' for a model itself; model is '' where no
 * model has any beginning of the name, and rest is the whole name then
 */
export function splitScoped(name: string, isModel: (name: string) => boolean): [string, string] {
  if (isModel(name)) return [name, ''];
  for (let end = name.lastIndexOf(SCOPE); end > 0; end = name.lastIndexOf(SCOPE, end - 1)) {
    if (isModel(name.slice(0, end))) return [name.slice(0, end), name.slice(end + SCOPE.length)];
  }
  return ['', name];
}

/** A name that is not taken: the wanted one, or with the first free number, as Gazebo's `name_0`. */
export function freeName(wanted: string, isTaken: (name: string) => boolean): string {
  let name = wanted;
  for (let number = 0; isTaken(name); number++) name = `${wanted}_${number}`;
  return name;
}
