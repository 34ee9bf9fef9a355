# What the Tab key of an interactive zsh makes of WORDS with the completions of FOLDER.
#   zsh -f completes.zsh FOLDER WORDS
zmodload zsh/zpty
home=$(mktemp -d)
trap 'rm -rf $home' EXIT
cat >$home/.zshrc <<END
PS1=
fpath=($1 \$fpath)
autoload -Uz compinit && compinit -u -D
bindkey '^I' complete-word '^X' told
zle-line-init() { print -n READY }
told() { print -rn -- "<\$BUFFER>"; zle kill-buffer }
zle -N zle-line-init
zle -N told
END
export ZDOTDIR=$home
zpty shell zsh -d -i
zpty -r shell line '*READY*'
zpty -w -n shell "$2"$'\t\x18'
zpty -r shell line '*<*>*'
print -r -- "${${line##*<}%%>*}"
zpty -d shell
