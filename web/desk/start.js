// Which page is shown follows the address, so that a reload and a link lead to the same place.
addEventListener('DOMContentLoaded', () => {
  const root = document.documentElement
  root.classList.toggle('light', kept('theme') ? kept('theme') === 'light' : matchMedia('(prefers-color-scheme: light)').matches)
  root.classList.toggle('large', kept('letters') === 'large')
  $('who').value = isToken(kept('who')) ? kept('who') : ''
  $('who').addEventListener('input', judgeWho)
  const show = async () => {
    if (desk.page) desk.page.leave()
    problem('')
    takeSecret()
    const [name, token] = location.hash.slice(1).split('/')
    desk.page = name === 'case' && token ? casePage(decodeURIComponent(token)) : name === 'new' ? newPage() : libraryPage()
    words()
    await doing(desk.page.show)()
    root.dataset.ready = desk.page.name
  }
  addEventListener('hashchange', () => {
    delete root.dataset.ready
    show()
  })
  $('home').addEventListener('click', () => {
    location.hash = 'library'
  })
  $('problem-close').addEventListener('click', () => problem(''))
  $('letters').addEventListener('click', () => keep('letters', root.classList.toggle('large') ? 'large' : 'small'))
  $('theme').addEventListener('click', () => {
    keep('theme', root.classList.toggle('light') ? 'light' : 'dark')
    words()
  })
  show()
})
