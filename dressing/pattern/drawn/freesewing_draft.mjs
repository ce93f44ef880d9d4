// Drafts a FreeSewing design to measurements [mm, degrees] and prints its SVG.
// Run by freesewing_draft.py in a folder that holds node_modules: design, measurements file.
const { readFileSync } = await import('node:fs')
const [design, file] = process.argv.slice(-2)
const stop = (code, text) => { console.error(text); process.exit(code) }
let module, plugins
try {
  module = await import(`@freesewing/${design}`)
  plugins = await import('@freesewing/core-plugins')
} catch (error) {
  const missing = /Cannot find package '([^']+)'/.exec(error.message)
  stop(3, missing ? missing[1] : error.message.split('\n')[0])
}
const Design = module[design[0].toUpperCase() + design.slice(1)]
const measurements = JSON.parse(readFileSync(file, 'utf8'))
const wanted = new Set((Design.patternConfig?.measurements || []))
const missing = [...wanted].filter((name) => !(name in measurements))
if (missing.length) stop(4, missing.join(', '))
const pattern = new Design({ measurements, sa: 0 })
pattern.use(plugins.corePlugins)
pattern.draft()
process.stdout.write(pattern.render())
